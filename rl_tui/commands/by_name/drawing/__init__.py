"""Commands for drawing worlds."""
