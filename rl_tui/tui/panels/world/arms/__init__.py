"""The arms of a bandit."""
