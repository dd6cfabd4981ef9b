"""An MDP as a graph."""
