"""Exact numbers of many policies in a small world, without Python."""
