"""Maps drawn in characters."""
