"""Going back in a run, and on from there another way."""
