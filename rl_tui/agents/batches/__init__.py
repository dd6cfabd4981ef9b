"""Many runs of one shape trained by one call of machine code."""
