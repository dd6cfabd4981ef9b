"""How the ids begin by which Gymnasium knows our own scenarios."""

OWN_IDS = "rl_tui/"
