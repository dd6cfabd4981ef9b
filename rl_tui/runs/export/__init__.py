"""A run written as a command, a script or tables."""
