"""Shared parts of all views of a world."""
