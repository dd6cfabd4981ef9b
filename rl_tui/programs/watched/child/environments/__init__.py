"""Environments of a watched program, which report their steps."""
