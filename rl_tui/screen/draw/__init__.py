"""Drawing tools for all panels."""
