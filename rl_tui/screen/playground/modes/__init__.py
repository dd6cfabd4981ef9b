"""Modes of the playground: while one is on, some keys are its own, whatever is in focus."""
