"""Recipe, journal and run, with training, timeline, exact answers and exports. May import agents and the
packages below.
"""
