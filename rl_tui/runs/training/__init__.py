"""Training without a screen: one run, many runs, benchmarks."""
