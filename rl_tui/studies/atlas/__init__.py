"""A map of two settings: what the runs of every combination come to, worked out while it is looked at."""
