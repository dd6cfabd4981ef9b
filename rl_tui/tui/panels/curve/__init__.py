"""The return curve panel."""
