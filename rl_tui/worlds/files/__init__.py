"""Scenario files: what may stand in them, and the worlds they describe."""
