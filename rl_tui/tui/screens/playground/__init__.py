"""The playground: one run on screen."""
