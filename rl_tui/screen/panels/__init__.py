"""The panels of the playground."""
