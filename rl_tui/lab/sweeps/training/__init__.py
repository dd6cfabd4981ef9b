"""How the runs of a cell are trained and looked at."""
