"""Commands that train many settings, and draw the results."""
