"""What the runs of one cell say together, measure by measure."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np

from rl_tui.lab.statistics.censored import arrivals_of
from rl_tui.lab.statistics.intervals import interquartile_mean, summary_of
from rl_tui.lab.sweeps.measures import ARRIVED, MEASURES, SweepMeasure
from rl_tui.lab.sweeps.runs import RunRow
from rl_tui.worlds.mdp.space import FloatArray

_EMPTY: Final = dict.fromkeys(("mean", "median", "iqm", "low", "high"))
_NO_ARRIVALS: Final = dict.fromkeys(
    ("share_low", "share_high", "restricted_mean", "restricted_low", "restricted_high")
)


@dataclass(frozen=True)
class CellSummary:
    """The rows of one cell in numbers."""

    runs: int
    """How many there are, those that broke down among them."""
    failed: int
    """How many broke down."""
    figures: dict[str, dict[str, Any]] = field(default_factory=dict)
    """For each measure its mean, median, iqm, low, high and count, in that order."""
    first_failure: str = ""
    """Why the first of them broke down."""


def values_by_seed(
    rows: Iterable[RunRow], measure: SweepMeasure, seeds: range
) -> tuple[FloatArray | None, bool]:
    """Return ``measure`` of each of ``seeds``, [N], NaN where there is none, and whether every row has it.

    None where there is no row. Runs that never arrive have the number of episodes that they had.
    """
    values, count = np.full(len(seeds), np.nan), 0
    for row in rows:
        count += 1
        value = _restricted(row) if measure.may_never_arrive else row.figures[measure.id]
        if value is not None and math.isfinite(value):
            values[row.seed - seeds.start] = value
    return (values if count else None), int((~np.isnan(values)).sum()) == count


def summarized(rows: Iterable[RunRow]) -> CellSummary:
    """Return what ``rows``, those of one cell, say together."""
    kept = list(rows)
    sound = [row for row in kept if row.failed is None]
    failures = [row.failed for row in kept if row.failed is not None]
    figures = {
        each.id: _arrivals(sound) if each.may_never_arrive else _figure(_values(sound, each.id))
        for each in MEASURES.values()
    }
    return CellSummary(len(kept), len(failures), figures, failures[0] if failures else "")


def _values(rows: Sequence[RunRow], name: str) -> list[float]:
    there = (row.figures[name] for row in rows)
    return [float(value) for value in there if value is not None and math.isfinite(value)]


def _figure(values: Sequence[float]) -> dict[str, Any]:
    found = summary_of(values)
    if found is None:
        return {**_EMPTY, "count": 0}
    return {name: getattr(found, name) for name in (*_EMPTY, "count")}


def _arrivals(rows: Sequence[RunRow]) -> dict[str, Any]:
    """Return the summary of arrivals, of which some are only known to be later than the end of training.

    Mean, iqm and interval are there only where all have arrived. ``restricted_mean`` is the mean of
    min(arrival, episodes), with its interval.
    """
    watched = [row for row in rows if row.figures[ARRIVED] is not None]
    times = np.array([row.figures["arrival"] if row.figures[ARRIVED] else np.nan for row in watched], float)
    found = arrivals_of(times, np.array([row.figures["episodes"] for row in watched], float))
    if found is None:
        return {**_EMPTY, "count": 0, "arrived": 0, **_NO_ARRIVALS}
    arrived = times[~np.isnan(times)]
    have_all = len(arrived) == len(times)
    return {
        "mean": found.restricted_mean if have_all else None,
        "median": found.median,
        "iqm": interquartile_mean(arrived) if have_all else None,
        "low": found.low if have_all else None,
        "high": found.high if have_all else None,
        "count": found.count,
        "arrived": len(arrived),
        "share_low": found.share_low,
        "share_high": found.share_high,
        "restricted_mean": found.restricted_mean,
        "restricted_low": found.low,
        "restricted_high": found.high,
    }


def _restricted(row: RunRow) -> float | None:
    """Return min(arrival, episodes) of ``row``; None where nobody can say."""
    if row.figures[ARRIVED] is None:
        return None
    return row.figures["arrival"] if row.figures[ARRIVED] else row.figures["episodes"]
