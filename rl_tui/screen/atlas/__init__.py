"""The settings map."""
