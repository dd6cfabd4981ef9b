"""What every screen has: keys, hints, arrangement."""
