"""The finite Markov decision process as flat arrays."""
