"""All actions, from which keys, palette, help and key line derive."""
