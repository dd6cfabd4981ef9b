"""Statistics of many runs as pure functions: intervals, comparisons, arrivals, sensitivity."""
