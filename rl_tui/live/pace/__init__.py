"""How fast a run moves on."""
