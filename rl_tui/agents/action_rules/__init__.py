"""How actions are chosen: one rule a file, joined by the families that every rule brings a member to."""
