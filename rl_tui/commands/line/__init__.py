"""Output, progress and screen start."""
