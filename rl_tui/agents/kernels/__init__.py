"""Compiled functions that others call, and the cache that keeps all machine code."""
