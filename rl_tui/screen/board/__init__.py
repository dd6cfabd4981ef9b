"""The board of the playground: its layout, its player, what is on it."""
