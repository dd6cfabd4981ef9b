"""Many runs: a grid of settings, each under many seeds, kept in a store."""
