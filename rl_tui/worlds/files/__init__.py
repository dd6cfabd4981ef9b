"""Scenario files: reading, and the list of all scenarios."""
