"""Watched programs on screen: what the playback is for built-in runs."""
