"""The visible runs under many seeds, computed in the background."""
