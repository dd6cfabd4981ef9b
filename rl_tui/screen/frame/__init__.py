"""Parts that every screen shares: arrangement, key line, help and hints."""
