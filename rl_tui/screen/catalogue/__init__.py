"""The start screen and the lesson list."""
