"""Panels of a program of somebody's own that is watched."""
