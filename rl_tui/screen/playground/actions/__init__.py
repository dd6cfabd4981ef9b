"""The actions of the playground: an object per subject, a method per key."""
