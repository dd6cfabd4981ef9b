"""Lessons: their files, figures and tasks, and how tasks are judged. May import programs and the packages
below.
"""
