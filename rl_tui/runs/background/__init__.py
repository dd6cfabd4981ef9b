"""Questions that a process of its own answers in the background."""
