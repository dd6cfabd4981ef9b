"""The World panel of maps."""
