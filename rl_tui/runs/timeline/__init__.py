"""Going back in a run, and continuing in a different way."""
