"""The map of a grid world."""
