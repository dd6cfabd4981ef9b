"""What is typed or imported: the command line, and what ``import rl_tui`` offers.

It imports screen, and the rooms below; no room imports it.
"""
