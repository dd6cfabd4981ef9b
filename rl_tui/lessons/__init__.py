"""Lessons: their files, figures and tasks, how tasks are judged, and what their author is told.

It imports programs, and the rooms below.
"""
