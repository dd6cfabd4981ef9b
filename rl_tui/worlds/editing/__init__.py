"""Editing of worlds: drafts, edits, saving, and the match between old and new world."""
