"""The numbers of a lesson's texts: what they are worked out by, and whether they are so."""
