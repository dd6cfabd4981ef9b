"""The dialogs over start screen and playground."""
