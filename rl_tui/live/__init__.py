"""A playing run: its thread, commands, snapshots and sessions. May import lessons and the packages below;
knows nothing of the screen.
"""
