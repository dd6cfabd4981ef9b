"""Policies, one per module: how actions are chosen."""
