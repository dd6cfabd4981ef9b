"""Modes, which take keys whatever has the focus."""
