"""Learning algorithms, each written like its box in Sutton & Barto (2nd ed.)."""
