"""The panel of many seeds."""
