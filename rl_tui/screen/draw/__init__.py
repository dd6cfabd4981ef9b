"""Drawing tools for all panels: cells, numbers, axes, dots."""
