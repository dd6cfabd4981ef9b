"""A run while it is played: the thread that owns it, its commands, its snapshots, and its sessions.

It imports lessons, and the rooms below. It knows nothing of what is drawn.
"""
