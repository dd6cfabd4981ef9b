"""The model of a world: what may follow each action."""
