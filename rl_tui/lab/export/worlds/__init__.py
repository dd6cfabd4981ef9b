"""Each kind of world as the text of a script."""
