"""What a learner does with a lesson, and what it keeps back."""
