"""The model of a world: the possible outcomes of each action."""
