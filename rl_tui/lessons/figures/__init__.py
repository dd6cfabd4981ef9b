"""The numbers in texts of lessons: their expressions, and the check of their values."""
