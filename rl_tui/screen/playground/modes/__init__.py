"""Modes of the playground, which take some keys whatever panel has the focus."""
