"""Commands that train many settings, and draw results."""
