"""Worlds made from Gymnasium environments."""
