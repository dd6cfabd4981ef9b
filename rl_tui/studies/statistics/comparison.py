"""Which cells of a sweep cannot be told from the best one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from rl_tui.studies.statistics.intervals import EQUAL, FEWEST_RUNS
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray

ERROR: Final = 0.05
"""The chance that a cell as good as the best is called different, over all cells together."""
METHOD: Final = "paired t-tests against the best, Holm's step-down corrected for the choice of the best"


@dataclass(frozen=True, eq=False)
class Comparison:
    """C cells against the one with the best mean.

    ``best`` is its index, None where no cell has a value. ``compared``, [C], are the cells that share enough
    seeds with it to be compared, itself among them; ``alike``, [C], those of them that could not be shown to
    be worse. ``method`` names the test and its correction.
    """

    best: int | None
    alike: BoolArray
    compared: BoolArray
    method: str = METHOD


def not_different(values: FloatArray, larger_is_better: bool = True) -> Comparison:
    """Compare cells, one a row of ``values``, [C, N], with the best of them; a column is a seed.

    A run that failed or is not there yet is NaN: two cells are compared by the seeds that both have, if these
    are at least ``FEWEST_RUNS``. The best is the first with the best mean among the cells that have as many
    runs, or where none has, among those that have most.

    It is chosen from the same numbers, so a test against it alone, corrected for the number of cells, errs
    far too often. A cell that is as good as any is called different only if it differs much, seed by seed,
    from one of the C − 1 others, any of which may be found best. With m such cells that are m (C − 1) pairs,
    by whose number ``ERROR`` is divided. m is at most C, and at most C − k once k cells were shown to be
    worse: S. Holm, "A Simple Sequentially Rejective Multiple Test Procedure", 1979. It holds however cells
    depend on each other. The question is that of J. C. Hsu, "Simultaneous Confidence Intervals for all
    Distances from the 'Best'", 1981.

    Raises ValueError if a value is infinite, or ``values`` is no matrix.
    """
    if values.ndim != 2 or np.isinf(values).any():
        raise ValueError("cells are compared by a matrix of finite numbers, NaN for a run that is not there")
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
    """Return the first row with the largest mean, of those that have enough runs, or else the most."""
    runs = there.sum(axis=1)
    eligible = runs >= min(FEWEST_RUNS, max(1, int(runs.max(initial=0))))
    if not eligible.any():
        return None
    sums = np.where(there, results, 0.0).sum(axis=1)
    return int(np.argmax(np.where(eligible, sums / np.maximum(runs, 1), -np.inf)))


def _chances(results: FloatArray, best: FloatArray, shared: BoolArray) -> FloatArray:
    """Return, for each row, the chance that an equal one comes out so far below ``best``: a paired t-test.

    Where all differences are the same there is no spread to compare with: it is 1 if they are 0, else 0.
    """
    from scipy.special import stdtr  # takes long to import

    differences = np.where(shared, best - results, 0.0)
    largest = np.max(np.maximum(np.abs(results), np.abs(best)), axis=1, initial=0.0, where=shared)
    differences[np.abs(differences) <= EQUAL * largest[:, np.newaxis]] = 0.0
    runs = shared.sum(axis=1)
    means = differences.sum(axis=1) / runs
    squares = np.where(shared, (differences - means[:, np.newaxis]) ** 2, 0.0).sum(axis=1)
    errors = np.sqrt(squares / (runs - 1) / runs)
    constant = np.where(means > 0.0, np.inf, -np.inf)
    t = np.divide(means, errors, out=constant, where=errors > 0.0)
    return np.asarray(stdtr(runs - 1, -t), np.float64)


def _worse(chances: FloatArray) -> IntArray:
    """Return the indices of the cells shown to be worse than the best, which is one more than these."""
    others = chances.size
    order = np.argsort(chances, kind="stable")
    levels = ERROR / (np.arange(others + 1, 1, -1.0) * others)
    passed = chances[order] <= levels
    return order[: others if passed.all() else int(np.argmin(passed))]
