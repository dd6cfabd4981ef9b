"""What commands print of a run, in words and tables."""
