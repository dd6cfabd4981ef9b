"""A sweep on a Dask cluster: batches go out as futures, and their rows come back to the one writer."""
