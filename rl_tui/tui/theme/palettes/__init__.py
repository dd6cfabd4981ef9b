"""A palette for each depth of colours."""
