"""Worlds that a person changes: what may be changed, what comes of it, and what stays the same in it."""
