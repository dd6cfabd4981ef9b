"""The Q-table panel."""
