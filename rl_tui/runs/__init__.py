"""Recipe, journal and run, with training, timeline, exact answers and exports."""
