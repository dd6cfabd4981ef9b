"""The World panel for worlds drawn as a graph."""
