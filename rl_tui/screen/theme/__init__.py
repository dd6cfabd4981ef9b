"""Palettes by colour depth and glyph sets."""
