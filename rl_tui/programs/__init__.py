"""Users' programs: run and watched in a process of their own, diagnosed, graded. May import studies and
the packages below.
"""
