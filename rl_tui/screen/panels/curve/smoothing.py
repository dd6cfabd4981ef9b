"""The mean of neighbouring bins of a curve."""

from __future__ import annotations

from typing import Final

import numpy as np

from rl_tui.worlds.mdp.space import FloatArray

_SMOOTHED_SHARE: Final = 24  # a mean is taken over one in so many of the bins


def smoothed(values: FloatArray) -> FloatArray:
    """Return the mean of each of ``values`` and its neighbours, one in 24 of all, fewer at the ends."""
    reach = len(values) // _SMOOTHED_SHARE // 2
    if reach == 0:
        return values
    sums = np.concatenate(([0.0], np.cumsum(values)))
    places = np.arange(len(values))
    first, behind = np.maximum(places - reach, 0), np.minimum(places + reach + 1, len(values))
    return np.asarray((sums[behind] - sums[first]) / (behind - first))
