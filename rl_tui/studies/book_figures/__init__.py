"""Figures of the book, recomputed and compared with the printed ones."""
