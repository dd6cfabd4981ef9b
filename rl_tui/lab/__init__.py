"""Runs: what was done, in what order, with which result. Nothing here draws."""
