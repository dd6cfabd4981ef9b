"""The diagnosis of a program from its steps: its update rule, and its bugs."""
