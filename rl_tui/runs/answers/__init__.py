"""Exact answers to questions about a run: policies, flip points, waits."""
