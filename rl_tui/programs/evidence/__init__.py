"""What was seen of a program's updates, and what they prove."""
