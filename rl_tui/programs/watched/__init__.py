"""Programs of other people that learn: run in a process of their own, and recorded as they go."""
