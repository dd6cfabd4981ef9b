"""Colours by depth, and sets of characters."""
