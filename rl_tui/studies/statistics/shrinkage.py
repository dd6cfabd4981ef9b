"""How much the best cell loses on fresh seeds."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from rl_tui.studies.statistics.intervals import Summary, summary_of


@dataclass(frozen=True, slots=True)
class Shrinkage:
    """The best cell as chosen (`first`), and `again` on fresh seeds.

    `shrunk` is the loss of the mean, negative if it was better again. `low` and `high` are its 95 % interval,
    None below ten runs.
    """

    first: Summary
    again: Summary
    shrunk: float
    low: float | None
    high: float | None


def shrinkage_of(
    first: Iterable[float], again: Iterable[float], larger_is_better: bool = True
) -> Shrinkage | None:
    """Compute how much worse `again` is than `first`, on different seeds, or None without values.

    The interval combines those of the two means (G. Y. Zou and A. Donner, "Construction of Confidence Limits
    About Effect Measures: A General Approach", 2008). For two shares it is method 10 of R. G. Newcombe,
    "Interval Estimation for the Difference Between Independent Proportions", 1998. Raises ValueError if a
    value is not finite.
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
