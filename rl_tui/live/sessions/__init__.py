"""Lessons and the sessions in which they were taken: progress, marks, and what authors are told."""
