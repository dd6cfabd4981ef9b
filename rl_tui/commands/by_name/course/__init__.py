"""Commands for lessons: take one, and grade results."""
