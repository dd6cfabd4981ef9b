"""What policies are worth, and what the other panels show of the one that is studied."""
