"""Learning algorithms, one per module, each written like its box in Sutton & Barto (2nd ed.)."""
