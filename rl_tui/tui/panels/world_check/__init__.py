"""What an author wants to know of the world in force."""
