"""Programs watched to their end: reports and grades."""
