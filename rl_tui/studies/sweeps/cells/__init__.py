"""Parts of a cell of a sweep: world, order, varying settings."""
