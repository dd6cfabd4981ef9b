"""As much of tqdm as the scripts use."""

from tqdm.std import tqdm, trange

__all__ = ["tqdm", "trange"]
