"""Who learns: algorithms, action rules and planners, their compiled loops, and the exact answers.

It imports worlds, and common.
"""
