"""Computations in a background process, which keep the screen free."""
