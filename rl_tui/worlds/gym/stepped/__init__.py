"""Environments without a transition table, stepped for real."""
