"""Exact answers about a run: policies, flip points, waits."""
