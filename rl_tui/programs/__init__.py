"""Somebody's own program: run and watched in a process of its own, diagnosed, graded.

It imports studies, and the rooms below.
"""
