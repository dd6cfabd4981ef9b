"""The tables of a scenario file that describe a world, and what their values may be."""
