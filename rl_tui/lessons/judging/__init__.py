"""The judging of tasks, by a replay of the run only."""
