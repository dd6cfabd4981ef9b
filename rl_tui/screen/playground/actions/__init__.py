"""What a person can do in the playground: an object for each subject, a method for each key."""
