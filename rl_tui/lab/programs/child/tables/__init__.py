"""The table of somebody's program: where it is, in which form, and what changes in it."""
