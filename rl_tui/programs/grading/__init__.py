"""Programs watched to their end: what they did, and how good what they learned is."""
