"""The compiled loops and the arrays they work on."""
