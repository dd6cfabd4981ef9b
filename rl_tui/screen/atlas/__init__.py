"""The atlas: a map of two settings, a cell for each combination, that fills while it is looked at."""
