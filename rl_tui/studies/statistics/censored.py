"""Times of arrival at a goal. Runs that do not arrive in their time are censored, not late."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from rl_tui.studies.statistics.intervals import FEWEST_RUNS, interval_of, share_interval
from rl_tui.worlds.mdp.space import FloatArray

_HALF: Final = 0.5 + 1e-9  # a product of shares that equals one half may be rounded up


@dataclass(frozen=True, slots=True)
class Arrivals:
    """The arrivals of some runs, in the unit of their times.

    Attributes:
        count: Number of runs.
        share: Share of runs that arrived, 0 to 1.
        share_low: Lower end of Wilson's 95 % interval of the share, None below ten runs.
        share_high: Upper end.
        median: First time by which half of all runs have arrived, None if not observed.
        restricted_mean: Mean of min(arrival, `horizon`), a mean time to arrival only if all arrived.
        low: Lower end of its 95 % interval, None below ten runs or if a run was not watched to the horizon.
        high: Upper end.
        horizon: Longest time that a run was watched.
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
    """Summarize arrivals, or return None without runs.

    Args:
        times: Time of arrival, NaN for a run that did not arrive, `[n]`.
        watched: Budget of each run, `[n]`, which must not depend on how it learns.

    Raises:
        ValueError: Shapes differ, a time is negative or exceeds the budget, or a budget is not finite.
    """
    if times.shape != watched.shape or times.ndim != 1 or not np.isfinite(watched).all():
        raise ValueError("each run needs a time, or NaN, and its length")
    arrived = ~np.isnan(times)
    if np.any((times < 0) | (times > watched) | (watched < 0)):
        raise ValueError("each time must be from 0 to the end of its run")
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
    """Estimate the share of runs that have not arrived (E. L. Kaplan and P. Meier, "Nonparametric Estimation
    from Incomplete Observations", 1958).

    At each moment the share falls by the part that arrives among the runs still watched, including those
    watched to that moment.

    Args:
        times: Time of arrival or NaN, `[n]`.
        watched: Budget of each run, `[n]`.

    Returns:
        Moments, `[m]`, rising from 0, and the share after each, `[m]`.
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
    """Return the mean of min(arrival, horizon), which is the area below the share."""
    return float(np.sum(still * np.diff(np.append(moments, horizon))))
