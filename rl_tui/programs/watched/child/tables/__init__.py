"""The forms of a program's table, its search, and its changes."""
