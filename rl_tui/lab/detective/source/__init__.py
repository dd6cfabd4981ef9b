"""The source of a program, read as text: where something stands in it, and what it is called there."""
