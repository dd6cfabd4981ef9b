"""The board and its link to the player."""
