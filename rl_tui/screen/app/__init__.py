"""The app and everything a person can do in it."""
