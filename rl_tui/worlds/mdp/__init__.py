"""The finite Markov decision process in flat arrays."""
