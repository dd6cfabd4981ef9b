"""What runs beside somebody's program, in its process: it sees every step, and finds the table."""
