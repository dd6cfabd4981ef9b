"""What many runs say together: intervals, comparisons, arrivals, what a choice is worth. Pure functions."""
