"""The board of the playground and its link to the player."""
