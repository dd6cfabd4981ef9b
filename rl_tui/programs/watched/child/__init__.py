"""Recording steps and finding the table, inside a watched program's process."""
