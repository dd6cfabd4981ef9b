"""The command line, and the functions that ``import rl_tui`` offers."""
