"""The dialogs over catalogue and playground."""
