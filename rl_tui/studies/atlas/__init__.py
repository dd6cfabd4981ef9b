"""The settings map: results of all combinations of two settings."""
