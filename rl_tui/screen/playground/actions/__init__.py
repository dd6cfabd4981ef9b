"""Actions: an object per subject, a method per key."""
