"""The layer between Textual and the terminal: input, output and their speed."""
