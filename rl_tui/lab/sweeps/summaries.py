"""What the runs of one cell say together, measure by measure."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np

from rl_tui.lab.statistics.intervals import interquartile_mean, summary_of
from rl_tui.lab.sweeps.measures import ARRIVED, MEASURES, Measure
from rl_tui.lab.sweeps.runs import RunRow
from rl_tui.worlds.mdp.space import FloatArray

_EMPTY: Final = dict.fromkeys(("mean", "median", "iqm", "low", "high"))


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


def values_by_seed(rows: Iterable[RunRow], measure: Measure, seeds: range) -> tuple[FloatArray | None, bool]:
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


def mean_of(rows: Iterable[RunRow], measure: Measure, seeds: range) -> float | None:
    """Return the mean of ``measure`` over ``rows``, which have some of ``seeds``; None where none has it."""
    values, _ = values_by_seed(rows, measure, seeds)
    there = [] if values is None else values[~np.isnan(values)].tolist()
    return math.fsum(there) / len(there) if there else None


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

    A mean there is only where all have arrived; median and iqm also where the late ones do not matter to
    them. ``restricted_mean`` is the mean of min(arrival, episodes).
    """
    watched = [row for row in rows if row.figures[ARRIVED] is not None]
    arrived = [row for row in watched if row.figures[ARRIVED]]
    found = _figure(_values(arrived, "arrival"))
    if len(arrived) < len(watched):
        ordered = sorted([*_values(arrived, "arrival"), *[math.inf] * (len(watched) - len(arrived))])
        found = {**_EMPTY, "median": _median(ordered), "iqm": _iqm(ordered), "count": len(watched)}
    everybody = [value for value in map(_restricted, watched) if value is not None]
    mean = math.fsum(everybody) / len(everybody) if everybody else None
    return {**found, "arrived": len(arrived), "restricted_mean": mean}


def _restricted(row: RunRow) -> float | None:
    """Return min(arrival, episodes) of ``row``; None where nobody can say."""
    if row.figures[ARRIVED] is None:
        return None
    return row.figures["arrival"] if row.figures[ARRIVED] else row.figures["episodes"]


def _median(ordered: Sequence[float]) -> float | None:
    middle = (ordered[(len(ordered) - 1) // 2] + ordered[len(ordered) // 2]) / 2
    return middle if math.isfinite(middle) else None


def _iqm(ordered: Sequence[float]) -> float | None:
    """Return the interquartile mean of ``ordered``; None where an infinite one has a part in it."""
    weightless = len(ordered) // 4  # so many at the end have none
    if not math.isfinite(ordered[len(ordered) - 1 - weightless]):
        return None
    largest = max(each for each in ordered if math.isfinite(each))
    return interquartile_mean([min(each, largest) for each in ordered])
