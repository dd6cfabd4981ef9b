"""Whether a task is solved: decided by the replay of a run alone."""
