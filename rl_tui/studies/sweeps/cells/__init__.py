"""Parts of a cell of a sweep: its world, its order, and its varying settings."""
