"""The best cell of a sweep, and the cells tied with it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from rl_tui.runs.measures import Measure
from rl_tui.studies.statistics.comparison import METHOD, not_different
from rl_tui.studies.sweeps.cell import JUDGED_BY, MEASURES, Cell, SkippedCell
from rl_tui.studies.sweeps.cells.variation import Value
from rl_tui.studies.sweeps.plan import SweepPlan, world_settings
from rl_tui.studies.sweeps.runs import values_by_seed
from rl_tui.studies.sweeps.store import Store
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray

MOST_SKIPPED_TOLD: Final = 20

_World = tuple[tuple[str, Value], ...]


@dataclass(frozen=True, eq=False)
class Ranking:
    """The C cells with runs in one world, compared by one metric.

    Runs that never arrive count with their number of episodes. Missing values make a mean too optimistic, so
    an incomplete cell is best only if all are.
    """

    indexes: IntArray
    """Numbers in the plan, ascending, `[C]`."""
    means: FloatArray
    """Means of the metric, NaN without a value, `[C]`."""
    best: Cell | None
    """The best cell (the first of equal ones), or None if no run has a value."""
    alike: BoolArray
    """True for cells tied with the best, including itself, `[C]`."""
    compared: BoolArray
    """True for cells with enough runs to compare, `[C]`."""

    def verdict(self, index: int) -> bool | None:
        """Return True if cell `index` ties with the best, or None."""
        place = int(np.searchsorted(self.indexes, index))
        return bool(self.alike[place]) if self.compared[place] else None

    @property
    def was_chosen(self) -> bool:
        """True if the best was chosen among several, perhaps by luck."""
        return self.best is not None and len(self.indexes) > 1


@dataclass(frozen=True, eq=False)
class Standings:
    """The comparison of the cells, in each world alone."""

    measure: Measure
    rankings: Mapping[_World, Ranking]
    """A ranking for each world, by its varying settings, in the order of the plan."""
    skipped: int
    """Number of cells that cannot work."""
    reasons: tuple[SkippedCell, ...]
    """The first of these."""
    method: str = METHOD

    def verdict(self, cell: Cell) -> bool | None:
        """Return True if `cell` ties with the best of its world, or None."""
        return self.rankings[_world(cell.settings)].verdict(cell.index)

    @property
    def bests(self) -> list[Cell]:
        """The best cell of each world."""
        return [each.best for each in self.rankings.values() if each.best is not None]

    @property
    def chosen(self) -> list[Cell]:
        """The best cells that were chosen among several."""
        return [each.best for each in self.rankings.values() if each.was_chosen and each.best is not None]

    def first(self, ranking: Ranking, count: int) -> list[int]:
        """Return the numbers of the `count` best cells, best first."""
        sign = -1.0 if self.measure.larger_is_better else 1.0
        order = np.argsort(sign * ranking.means, kind="stable")  # NaN last
        ranked = [int(ranking.indexes[place]) for place in order[: count + 1]]
        if ranking.best is not None:
            best = ranking.best.index
            ranked = [best, *(index for index in ranked if index != best)]
        return ranked[:count]


def standings_of(plan: SweepPlan, store: Store, measure: Measure | None = None) -> Standings:
    """Compare the cells of `plan`, by default by the first of `JUDGED_BY` with values."""
    candidates = [measure] if measure is not None else [MEASURES[name] for name in JUDGED_BY]
    found = [_standings(plan, store, candidates[0])]
    while not found[-1].bests and len(found) < len(candidates):
        found.append(_standings(plan, store, candidates[len(found)]))
    return found[-1] if found[-1].bests else found[0]


class _Values:
    def __init__(self) -> None:
        self.indexes = list[int]()
        self.values = list[FloatArray]()
        self.complete = list[bool]()

    def add(self, index: int, values: FloatArray, is_complete: bool) -> None:
        self.indexes.append(index)
        self.values.append(values)
        self.complete.append(is_complete)


def _standings(plan: SweepPlan, store: Store, measure: Measure) -> Standings:
    skipped, reasons, worlds = 0, list[SkippedCell](), dict[_World, _Values]()
    for index in range(plan.count):
        cell = plan.cell(index)
        if isinstance(cell, SkippedCell):
            skipped += 1
            if len(reasons) < MOST_SKIPPED_TOLD:
                reasons.append(cell)
            continue
        found, is_complete = values_by_seed(store.rows(cell.key, plan.seeds), measure, plan.seeds)
        if found is not None:
            worlds.setdefault(_world(cell.settings), _Values()).add(index, found, is_complete)
    rankings = {world: _ranking(plan, values, measure) for world, values in worlds.items()}
    return Standings(measure, rankings, skipped, tuple(reasons))


def _ranking(plan: SweepPlan, gathered: _Values, measure: Measure) -> Ranking:
    matrix, complete = np.array(gathered.values), np.array(gathered.complete)
    judged = np.where(complete[:, np.newaxis], matrix, np.nan) if complete.any() else matrix
    compared = not_different(judged, bool(measure.larger_is_better))
    best = None if compared.best is None else plan.cell(gathered.indexes[compared.best])
    return Ranking(
        np.array(gathered.indexes, dtype=np.int64),
        _means(matrix),
        best if isinstance(best, Cell) else None,
        compared.alike,
        compared.compared,
    )


def _world(settings: Mapping[str, Value]) -> _World:
    return tuple(world_settings(settings).items())


def _means(matrix: FloatArray) -> FloatArray:
    there = ~np.isnan(matrix)
    count = there.sum(axis=1)
    sums = np.where(there, matrix, 0.0).sum(axis=1)
    return np.where(count > 0, sums / np.maximum(count, 1), np.nan)
