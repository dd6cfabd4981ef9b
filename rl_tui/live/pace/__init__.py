"""The speed of a run."""
