"""The panel of the last step."""
