"""The screen on which runs are watched."""
