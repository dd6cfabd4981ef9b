"""The world tables of a scenario file, and the values they accept."""
