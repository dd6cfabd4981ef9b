"""Programs that learners write for a task: watched to their end, and what that comes to."""
