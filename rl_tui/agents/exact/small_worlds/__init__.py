"""Exact figures of many policies in a small world, by kernels that run without Python."""
