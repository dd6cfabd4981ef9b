"""Sweeps on a Dask cluster: batches are sent as futures, rows return to the single writer."""
