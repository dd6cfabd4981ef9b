"""The World panel of graphs."""
