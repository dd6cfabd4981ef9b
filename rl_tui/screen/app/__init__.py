"""The app and the screens it opens."""
