"""The update rule and the bugs of a program, from its steps."""
