"""Saved sessions and lessons: files, progress and grading."""
