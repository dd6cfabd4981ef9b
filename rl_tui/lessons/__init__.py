"""The files, figures and tasks of lessons. May import programs and the packages below."""
