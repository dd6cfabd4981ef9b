"""Helpers for all packages: errors, limits, words, safe files and random streams. This package imports no
other.
"""
