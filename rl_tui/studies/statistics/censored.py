"""When runs arrive at a goal, if some do not within the time they have: those are censored, not late."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from rl_tui.studies.statistics.intervals import FEWEST_RUNS, interval_of, share_interval
from rl_tui.worlds.mdp.space import FloatArray

_HALF: Final = 0.5 + 1e-9  # a product of shares that should be one half may come out above it, by rounding


@dataclass(frozen=True, slots=True)
class Arrivals:
    """The arrivals of some runs, in the unit of their times.

    ``share`` of the ``count`` runs arrived, with Wilson's 95 % interval ``share_low`` .. ``share_high``.
    ``median`` is the first time by which at least half of all runs have arrived; None if that is not seen.
    ``restricted_mean`` is the mean of the time to arrival or ``horizon``, whichever comes first: not a mean
    time to arrival unless all arrived. ``low`` .. ``high`` is its 95 % interval. Intervals are None below ten
    runs, the last one also where some run was not watched to the horizon.
    """

    count: int
    share: float
    share_low: float | None
    share_high: float | None
    median: float | None
    restricted_mean: float | None
    low: float | None
    high: float | None
    horizon: float


def arrivals_of(times: FloatArray, watched: FloatArray) -> Arrivals | None:
    """Return what is known of arrival from ``times``, [n], NaN for a run that did not arrive; None without
    any.

    ``watched``, [n], is how long each run had: its budget. That of a run that arrived counts only for the
    horizon, which is the longest of all. Runs must not have been stopped because they were slow or quick to
    learn, or what is left is no fair sample. Where all have the same budget, that is certain.

    Raises ValueError if shapes differ, a time is negative or longer than it was watched, or a budget is not
    finite.
    """
    if times.shape != watched.shape or times.ndim != 1 or not np.isfinite(watched).all():
        raise ValueError("each run needs a time, or NaN, and how long it was watched")
    arrived = ~np.isnan(times)
    if np.any((times < 0) | (times > watched) | (watched < 0)):
        raise ValueError("a run arrives between 0 and the end of the time it was watched")
    count, reached = times.size, int(arrived.sum())
    if not count:
        return None
    horizon = float(watched.max())
    moments, still = still_under_way(times, watched)
    known = bool(still[-1] == 0.0 or np.any(watched[~arrived] == horizon))
    restricted = np.where(arrived, times, horizon)
    all_watched = bool(np.all(watched[~arrived] == horizon))
    low, high = (interval_of(restricted) if all_watched else None) or (None, None)
    share_low, share_high = share_interval(reached, count) if count >= FEWEST_RUNS else (None, None)
    return Arrivals(
        count,
        reached / count,
        share_low,
        share_high,
        _first_half(moments, still),
        _area(moments, still, horizon) if known else None,
        low,
        high,
        horizon,
    )


def still_under_way(times: FloatArray, watched: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the moments of arrivals, [m], rising from 0, and the share of runs not yet there after each.

    At every moment the share falls by the part of those that arrive among those still watched, a run that is
    watched to that very moment included: E. L. Kaplan and P. Meier, "Nonparametric Estimation from Incomplete
    Observations", 1958. Between two moments it stays; the first is 0, at which it is 1 if no run arrives so
    soon.
    """
    arrived = ~np.isnan(times)
    moments, arrivals = np.unique(times[arrived], return_counts=True)
    seen = np.sort(np.where(arrived, times, watched))
    at_risk = times.size - np.searchsorted(seen, moments)
    still: FloatArray = np.cumprod((at_risk - arrivals) / at_risk, dtype=np.float64)
    if moments.size and moments[0] == 0.0:
        return moments, still
    return np.append(0.0, moments), np.append(1.0, still)


def _first_half(moments: FloatArray, still: FloatArray) -> float | None:
    there = np.flatnonzero(still <= _HALF)
    return float(moments[there[0]]) if there.size else None


def _area(moments: FloatArray, still: FloatArray, horizon: float) -> float:
    """Return the mean of the time to arrival or the horizon: the area below the share not yet there."""
    return float(np.sum(still * np.diff(np.append(moments, horizon))))
