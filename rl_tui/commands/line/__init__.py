"""Output, progress and screen start, shared by all commands."""
