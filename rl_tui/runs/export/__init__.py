"""A run written down for others: as a command, a script, tables."""
