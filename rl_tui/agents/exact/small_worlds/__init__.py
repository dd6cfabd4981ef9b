"""Exact figures of many policies of one small world at once, by kernels that need no Python in between."""
