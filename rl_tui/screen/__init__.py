"""All that draws. It sees a run by its snapshots only."""
