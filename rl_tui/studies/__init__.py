"""Studies of many runs. A study imports only studies to its left."""
