"""rl-tui: watch a tabular reinforcement-learning agent learn, in any terminal."""

__version__ = "0.1.0"
