"""The environments of a watched program: made, seeded, and wrapped so that each step is seen."""
