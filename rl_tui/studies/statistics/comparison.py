"""The cells of a sweep that are tied with the best."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from rl_tui.studies.statistics.intervals import EQUAL, FEWEST_RUNS, student_share
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray

ERROR: Final = 0.05
"""Probability of calling any cell as good as the best different."""
METHOD: Final = "paired t-tests against the best, with Holm's correction, and one for the choice of the best"


@dataclass(frozen=True, eq=False)
class Comparison:
    """C cells compared with the one with the best mean.

    Attributes:
        best: Index of the best cell, None without values.
        alike: True for cells not shown to be worse than the best, including itself, `[C]`.
        compared: True for cells with enough common seeds, including the best, `[C]`.
        method: Name of the test and its correction.
    """

    best: int | None
    alike: BoolArray
    compared: BoolArray
    method: str = METHOD


def not_different(values: FloatArray, larger_is_better: bool = True) -> Comparison:
    """Compare cells with the first that has the best mean, among those with enough runs or else with most.

    Two cells are compared by their common seeds, if these are at least `FEWEST_RUNS`. The best is chosen from
    the same numbers, so `ERROR` is divided by the m (C − 1) pairs of an equal cell and a best one: m is at
    most C, and at most C − k once k cells were shown to be worse (S. Holm, "A Simple Sequentially Rejective
    Multiple Test Procedure", 1979; J. C. Hsu, "Simultaneous Confidence Intervals for all Distances from the
    'Best'", 1981).

    Args:
        values: Results, `[C, N]`, a column for each seed, NaN for a missing run.
        larger_is_better: Direction of the metric.

    Raises:
        ValueError: A value is infinite, or `values` is not a matrix.
    """
    if values.ndim != 2 or np.isinf(values).any():
        raise ValueError("cells need a matrix of finite numbers, with NaN for a missing run")
    results = values if larger_is_better else -values
    there = ~np.isnan(results)
    best = _best(results, there)
    if best is None:
        nobody = np.zeros(len(values), np.bool_)
        return Comparison(None, nobody, nobody)
    shared = there & there[best]
    compared = shared.sum(axis=1) >= FEWEST_RUNS
    compared[best] = True
    others = np.flatnonzero(compared & (np.arange(len(values)) != best))
    alike = compared.copy()
    if others.size:
        chances = _chances(results[others], results[best], shared[others])
        alike[others[_worse(chances)]] = False
    return Comparison(best, alike, compared)


def _best(results: FloatArray, there: BoolArray) -> int | None:
    runs = there.sum(axis=1)
    eligible = runs >= min(FEWEST_RUNS, max(1, int(runs.max(initial=0))))
    if not eligible.any():
        return None
    sums = np.where(there, results, 0.0).sum(axis=1)
    return int(np.argmax(np.where(eligible, sums / np.maximum(runs, 1), -np.inf)))


def _chances(results: FloatArray, best: FloatArray, shared: BoolArray) -> FloatArray:
    """Return the p-value of each row in a paired t-test against `best`.

    Constant differences give 1 if they are 0, else 0.
    """
    differences = np.where(shared, best - results, 0.0)
    largest = np.max(np.maximum(np.abs(results), np.abs(best)), axis=1, initial=0.0, where=shared)
    differences[np.abs(differences) <= EQUAL * largest[:, np.newaxis]] = 0.0
    runs = shared.sum(axis=1)
    means = differences.sum(axis=1) / runs
    squares = np.where(shared, (differences - means[:, np.newaxis]) ** 2, 0.0).sum(axis=1)
    errors = np.sqrt(squares / (runs - 1) / runs)
    constant = np.where(means > 0.0, np.inf, -np.inf)
    t = np.divide(means, errors, out=constant, where=errors > 0.0)
    return np.array([student_share(-t_of, runs_of - 1) for t_of, runs_of in zip(t, runs, strict=True)])


def _worse(chances: FloatArray) -> IntArray:
    """Return the indexes of the cells shown to be worse than the best."""
    others = chances.size
    order = np.argsort(chances, kind="stable")
    levels = ERROR / (np.arange(others + 1, 1, -1.0) * others)
    passed = chances[order] <= levels
    return order[: others if passed.all() else int(np.argmin(passed))]
