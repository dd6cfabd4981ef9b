"""The panels of the playground, a folder for each."""
