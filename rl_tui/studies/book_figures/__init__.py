"""Figures of the book, recomputed by this program and held against the printed ones."""
