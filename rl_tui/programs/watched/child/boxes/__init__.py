"""Environments whose observations have fractions: the state is what indexes the table."""
