"""Scenarios as Gymnasium environments."""
