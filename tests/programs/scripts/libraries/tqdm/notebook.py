"""Bars of a notebook, which can be made nowhere else."""


def tqdm_notebook(*_, **__):
    """Refuse, as where ipywidgets is not installed."""
    raise ImportError("IProgress not found. Please update jupyter and ipywidgets.")


tqdm = trange = tnrange = tqdm_notebook
