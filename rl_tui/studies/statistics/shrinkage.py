"""How much of its lead the best cell loses when it is run again on fresh seeds."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from rl_tui.studies.statistics.intervals import Summary, summary_of


@dataclass(frozen=True, slots=True)
class Shrinkage:
    """A cell when it was chosen as the best, the same on fresh seeds, and what lies between.

    ``shrunk`` is by how much the mean was worse again, in its unit; below 0 it was better. ``low`` ..
    ``high`` is the 95 % interval of that, None if one of both has fewer than ten runs.
    """

    first: Summary
    again: Summary
    shrunk: float
    low: float | None
    high: float | None


def shrinkage_of(
    first: Iterable[float], again: Iterable[float], larger_is_better: bool = True
) -> Shrinkage | None:
    """Return how much worse ``again`` is than ``first``, whose seeds are others; None without any of one.

    The best of many looks better than it is, since luck helped to choose it: what it shrinks by is that luck.
    The interval of the difference is put together from those of the two means, each end from the distances
    that push it: G. Y. Zou and A. Donner, "Construction of Confidence Limits About Effect Measures: A General
    Approach", 2008. Of two shares it is R. G. Newcombe, "Interval Estimation for the Difference Between
    Independent Proportions", 1998, method 10.

    Raises ValueError if a value is not finite.
    """
    before, after = summary_of(first), summary_of(again)
    if before is None or after is None:
        return None
    better, worse = (before, after) if larger_is_better else (after, before)
    shrunk = better.mean - worse.mean
    if better.low is None or better.high is None or worse.low is None or worse.high is None:
        return Shrinkage(before, after, shrunk, None, None)
    down = ((better.mean - better.low) ** 2 + (worse.high - worse.mean) ** 2) ** 0.5
    up = ((better.high - better.mean) ** 2 + (worse.mean - worse.low) ** 2) ** 0.5
    return Shrinkage(before, after, shrunk, shrunk - down, shrunk + up)
