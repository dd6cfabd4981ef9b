"""What was done: recipe, journal and run, training, the timeline, answers beside a run, exports.

It imports agents, and the rooms below.
"""
