"""Finite MDPs, scenario files, maps, graphs, bandits and Gymnasium environments."""
