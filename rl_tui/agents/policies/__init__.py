"""Policies: how actions are chosen, one a file."""
