"""The prefix of our scenario ids in Gymnasium."""

OWN_IDS = "rl_tui/"
