"""Sweeps: a grid of settings, each under many seeds, with the runs in a store."""
