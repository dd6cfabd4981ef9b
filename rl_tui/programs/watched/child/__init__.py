"""The code inside a watched program's process, which records steps and finds the table."""
