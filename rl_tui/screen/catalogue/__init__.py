"""The start screen with scenarios and saved sessions, and the list of lessons."""
