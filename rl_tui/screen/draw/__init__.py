"""What every picture is drawn with: cells, numbers, axes, dots."""
