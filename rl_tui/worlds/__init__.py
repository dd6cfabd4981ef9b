"""What there is to learn: finite MDPs, scenario files, maps and graphs, environments of Gymnasium.

It imports common.
"""
