"""Machine code: from the cache, a worker process, or compiled here."""
