"""The last step of a run in numbers."""
