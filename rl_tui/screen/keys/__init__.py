"""What a person can do, once: keys, palette, help and key line derive from it."""
