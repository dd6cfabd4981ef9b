"""A playing run, its commands, snapshots and sessions. May import lessons and the packages below."""
