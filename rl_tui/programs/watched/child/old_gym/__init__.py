"""The old Gym for watched programs: Gymnasium under its old names and in its old form."""
