"""What every room may use: errors and findings, limits, words, safe files, the random streams.

It imports no other room.
"""
