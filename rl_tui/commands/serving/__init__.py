"""The server of ``rl-tui serve``."""
