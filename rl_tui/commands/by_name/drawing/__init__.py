"""Commands for people who draw worlds."""
