"""Panels of a watched program."""
