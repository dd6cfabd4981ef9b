"""Studies of many runs: sweeps, statistics, pictures, figures of the book, world checks. May import runs
and the packages below. A study imports only studies to its left.
"""
