"""Colours by colour depth, and sets of characters."""
