"""What an author wants to know of a world before a class gets it."""
