"""Drawing the world: which keys and clicks change what in it."""
