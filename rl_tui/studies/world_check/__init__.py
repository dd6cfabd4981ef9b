"""The world check: facts that an author needs about a world."""
