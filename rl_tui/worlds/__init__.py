"""Worlds: finite MDPs, scenario files, maps, graphs, bandits and Gymnasium environments. This package imports
only common.
"""
