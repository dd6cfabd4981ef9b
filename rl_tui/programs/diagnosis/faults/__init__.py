"""Possible bugs of a program, one subject per module, with their proofs."""
