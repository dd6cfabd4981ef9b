"""Getting machine code: from the cache, from a process of its own, or by compiling it here."""
