"""Machine code: read from the cache, compiled by a worker process, or compiled here."""
