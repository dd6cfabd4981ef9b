"""The playground: the screen of a run."""
