"""What a person draws of the world of a run, and what stays with its cell meanwhile."""
