"""The judging of tasks, by replays only."""
