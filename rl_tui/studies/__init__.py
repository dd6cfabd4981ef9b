"""What many runs say together: sweeps, statistics, pictures, figures of the book, checks of a world.

It imports runs, and the rooms below. No study imports another but for what stands left of it.
"""
