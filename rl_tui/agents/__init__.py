"""Learning: algorithms, policies and planners, their compiled loops, and exact answers. This package imports
worlds and common.
"""
