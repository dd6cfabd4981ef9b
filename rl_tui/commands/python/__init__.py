"""rl-tui from Python: what ``import rl_tui`` offers."""
