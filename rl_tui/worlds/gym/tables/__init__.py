"""Environments whose transition table is known."""
