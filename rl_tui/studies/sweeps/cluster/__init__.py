"""Sweeps on a Dask cluster: batches are sent as futures, and rows return to the single writer."""
