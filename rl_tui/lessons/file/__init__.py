"""Lesson files: schema, setups, variants, and a learner's progress."""
