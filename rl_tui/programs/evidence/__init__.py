"""The evidence about a program's updates: steps, changes, and its source."""
