"""The words of the program, each with its meaning, its equation and where the book has it."""
