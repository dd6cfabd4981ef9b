"""A run on screen: the thread that owns it, its commands, and the snapshots it publishes."""
