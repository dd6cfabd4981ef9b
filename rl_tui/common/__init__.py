"""Errors, limits, words, safe files and random streams."""
