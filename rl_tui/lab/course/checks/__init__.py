"""What is looked for in a lesson file beyond its form: one kind of fault a module."""
