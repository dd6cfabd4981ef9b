"""What there is to learn: finite MDPs, scenario files, Gymnasium adaptors."""
