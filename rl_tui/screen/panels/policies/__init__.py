"""The panel of policies, and the studied policy."""
