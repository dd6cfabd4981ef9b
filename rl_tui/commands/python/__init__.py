"""The Python interface: the functions of ``import rl_tui``."""
