"""Users' learning programs, run and recorded in a separate process."""
