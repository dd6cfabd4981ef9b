"""Which cell of a sweep is best, and which others cannot be told from it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from rl_tui.lab.statistics.comparison import METHOD, not_different
from rl_tui.lab.sweeps.cell import Cell, SkippedCell
from rl_tui.lab.sweeps.measures import JUDGED_BY, MEASURES, Measure
from rl_tui.lab.sweeps.plan import SweepPlan
from rl_tui.lab.sweeps.store import Store
from rl_tui.lab.sweeps.summaries import values_by_seed
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray

MOST_SKIPPED_TOLD: Final = 20


@dataclass(frozen=True, eq=False)
class Ranking:
    """The C cells that there are runs of, by one measure.

    Runs that never arrive count with the number of episodes that they had. Where a run of a cell broke down,
    or has no value, the mean of the others says too much of it: such a cell is best only where all are such.
    """

    measure: Measure
    """By which they are compared."""
    indexes: IntArray
    """[C], their numbers in the plan, ascending."""
    means: FloatArray
    """[C], the mean of the measure; NaN where no run has it."""
    best: Cell | None
    """The best cell, the first of equals; None where no run has the measure."""
    alike: BoolArray
    """[C], which cannot be told from the best, itself among them."""
    compared: BoolArray
    """[C], which could be compared with it: both have enough runs."""
    skipped: int
    """How many cells of the plan cannot work."""
    reasons: tuple[SkippedCell, ...]
    """The first of these."""
    method: str = METHOD

    def verdict(self, index: int) -> bool | None:
        """Return whether cell ``index`` of the plan is like the best; None where it was not compared."""
        place = int(np.searchsorted(self.indexes, index))
        return bool(self.alike[place]) if self.compared[place] else None

    def first(self, count: int) -> list[int]:
        """Return the numbers in the plan of the ``count`` best cells by their means, the best one first."""
        sign = -1.0 if self.measure.larger_is_better else 1.0
        order = np.argsort(sign * self.means, kind="stable")  # NaN last
        ranked = [int(self.indexes[place]) for place in order[: count + 1]]
        if self.best is not None:
            ranked = [self.best.index, *(index for index in ranked if index != self.best.index)]
        return ranked[:count]


def ranking_of(plan: SweepPlan, store: Store, measure: Measure | None = None) -> Ranking:
    """Return how the cells of ``plan`` that ``store`` has runs of compare by ``measure``.

    Without one it is the first of the usual ones that any run has.
    """
    candidates = [measure] if measure is not None else [MEASURES[name] for name in JUDGED_BY]
    for candidate in candidates:
        found = _ranking(plan, store, candidate)
        if found.best is not None:
            return found
    return found if len(candidates) == 1 else _ranking(plan, store, candidates[0])


def _ranking(plan: SweepPlan, store: Store, measure: Measure) -> Ranking:
    indexes, values, complete = list[int](), list[FloatArray](), list[bool]()
    skipped, reasons = 0, list[SkippedCell]()
    for index in range(plan.count):
        cell = plan.cell(index)
        if isinstance(cell, SkippedCell):
            skipped += 1
            if len(reasons) < MOST_SKIPPED_TOLD:
                reasons.append(cell)
            continue
        found, is_complete = values_by_seed(store.rows(cell.key, plan.seeds), measure, plan.seeds)
        if found is not None:
            indexes.append(index)
            values.append(found)
            complete.append(is_complete)
    matrix = np.array(values).reshape(len(values), plan.runs)
    whole = np.array(complete, dtype=np.bool_)
    judged = np.where(whole[:, np.newaxis], matrix, np.nan) if whole.any() else matrix
    compared = not_different(judged, bool(measure.larger_is_better))
    best = None if compared.best is None else plan.cell(indexes[compared.best])
    return Ranking(
        measure,
        np.array(indexes, dtype=np.int64),
        _means(matrix),
        best if isinstance(best, Cell) else None,
        compared.alike,
        compared.compared,
        skipped,
        tuple(reasons),
        compared.method,
    )


def _means(matrix: FloatArray) -> FloatArray:
    there = ~np.isnan(matrix)
    count = there.sum(axis=1)
    sums = np.where(there, matrix, 0.0).sum(axis=1)
    return np.where(count > 0, sums / np.maximum(count, 1), np.nan)
