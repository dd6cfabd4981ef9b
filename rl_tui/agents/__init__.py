"""Learning: algorithms, policies and planners, their compiled loops, and exact answers."""
