"""The same runs under many seeds, worked out beside the one on screen."""
