"""What stands between the compositor and the terminal: differences only, and no faster than they arrive."""
