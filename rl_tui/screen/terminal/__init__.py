"""Between Textual and the terminal: what is read, what is written, and how fast."""
