"""Drafts, edits, saving, and the match of old and new worlds."""
