"""Training of many runs by one call of machine code."""
