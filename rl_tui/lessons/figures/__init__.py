"""The numbers in texts of lessons, recomputed from expressions."""
