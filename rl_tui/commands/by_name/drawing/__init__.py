"""Commands for those who draw worlds."""
