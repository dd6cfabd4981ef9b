"""The text of every policy for exported scripts, one a file."""
