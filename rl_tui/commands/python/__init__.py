"""The functions of ``import rl_tui``."""
