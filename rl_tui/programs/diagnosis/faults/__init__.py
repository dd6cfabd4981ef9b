"""What may be wrong with a program, a subject each: what steps prove of it."""
