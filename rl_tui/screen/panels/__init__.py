"""The panels of the playground, one a folder."""
