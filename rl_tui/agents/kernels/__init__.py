"""Compiled functions that others call: what runs add up of their episodes."""
