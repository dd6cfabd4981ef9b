"""The training loop of each algorithm as the text of a script; a module is called as the algorithm is."""
