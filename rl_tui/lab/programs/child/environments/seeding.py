"""A seed for all chance of a program that gives none itself."""

from __future__ import annotations

import random
from itertools import count
from typing import Any

import numpy as np


def seed_all(seed: int) -> None:
    """Seed ``random``, NumPy's legacy generator, and each ``default_rng()`` that is given nothing."""
    random.seed(seed)
    np.random.seed(seed % 2**32)
    original, made = np.random.default_rng, count(1)

    def default_rng(seed_given: Any = None) -> np.random.Generator:
        """Return a generator; one without a seed of its own has that of the run and its own number."""
        return original([seed, next(made)] if seed_given is None else seed_given)

    np.random.default_rng = default_rng  # type: ignore[assignment]
