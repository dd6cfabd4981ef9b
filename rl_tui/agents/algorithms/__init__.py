"""One learning algorithm a file, each reading like its boxed pseudocode in Sutton & Barto (2nd ed.)."""
