"""Lessons: files that tell, ask and set tasks, and the judging of what was done."""
