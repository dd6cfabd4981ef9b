"""The compiled loops and their data."""
