"""Commands of lessons: taking one, and judging what came of it."""
