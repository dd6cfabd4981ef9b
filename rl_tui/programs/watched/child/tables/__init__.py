"""The table of a watched program: its forms, the search for it, and its changes."""
