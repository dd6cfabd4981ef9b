"""What a program does to its table, worked out from its steps: the update, and what is wrong with it."""
