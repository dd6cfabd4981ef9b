"""What each hypothesis about an update predicts, and how its numbers are found."""
