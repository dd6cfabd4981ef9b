"""Writes no pictures."""
