"""What a cell of a sweep is made of: its world, its order among the others, and what makes up its key."""
