"""A run: its recipe, its journal, and what came of them."""
