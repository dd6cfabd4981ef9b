"""Worlds of a program's own, which are not Gymnasium's."""
