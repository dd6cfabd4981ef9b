"""The old Gym for watched programs, made of Gymnasium."""
