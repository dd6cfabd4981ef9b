"""The world tables of a scenario file, and accepted values."""
