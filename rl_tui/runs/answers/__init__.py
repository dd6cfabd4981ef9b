"""Exact answers to what a person asks of a run: policies, flip points, waits."""
