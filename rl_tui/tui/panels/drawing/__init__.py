"""The panel of tools while a person draws the world."""
