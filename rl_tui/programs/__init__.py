"""Users' programs: watched, diagnosed and graded. May import studies and the packages below."""
