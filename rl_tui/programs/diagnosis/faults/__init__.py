"""Possible bugs of a program, with their proofs."""
