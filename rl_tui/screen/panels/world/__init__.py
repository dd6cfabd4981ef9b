"""The world panel: one folder for each kind of drawing."""
