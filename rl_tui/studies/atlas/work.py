"""The work of a settings map: a small sweep."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import product
from statistics import median
from typing import Any, Final

from rl_tui.agents.compiling.background import BACKGROUND
from rl_tui.agents.compiling.cache_folder import was_compiled
from rl_tui.runs.background.child import let_others_go_first
from rl_tui.runs.measures import Measure
from rl_tui.runs.recipe import begin
from rl_tui.runs.run import Run
from rl_tui.studies.atlas.figures import Atlas, AtlasCell, AtlasStandings, AtlasState
from rl_tui.studies.atlas.request import AtlasRequest
from rl_tui.studies.sweeps.cell import MEASURES, Cell, SkippedCell
from rl_tui.studies.sweeps.plan import SweepPlan
from rl_tui.studies.sweeps.ranking import standings_of
from rl_tui.studies.sweeps.runs import RunRow, summarized
from rl_tui.studies.sweeps.store import Store
from rl_tui.studies.sweeps.sweep import SweepProgress, run_sweep

MOST_SECONDS: Final = 120.0
"""CPU-time limit of a map in seconds."""
MOST_STEPS: Final = 60_000_000
"""Approximate limit of the steps in all runs, some seconds of work."""
FIRST_STEPS: Final = 10_000
"""Steps with which the length of episodes is estimated, in the current cell and the corners."""
_FIGURES: Final = ("mean", "median", "low", "high", "count", "arrived", "restricted_mean")
Tell = Callable[[Atlas], None]


def work(request: AtlasRequest, tell: Callable[[Atlas, float], None]) -> None:
    """Compute the map, with the lowest priority once there is a cell."""
    has_cells = False

    def tell_atlas(atlas: Atlas) -> None:
        nonlocal has_cells
        tell(atlas, atlas.done / atlas.planned)
        if atlas.cells and not has_cells and not request.is_awaited:
            let_others_go_first()
        has_cells = bool(atlas.cells)

    AtlasWork(request, tell_atlas).run()


class AtlasWork:
    """Computes the map for `request` and calls `tell` with each result. `clock` returns CPU seconds."""

    def __init__(
        self, request: AtlasRequest, tell: Tell, clock: Callable[[], float] = time.process_time
    ) -> None:
        self._request = request
        self._tell = tell
        self._clock = clock
        self._atlas = request.nothing_yet
        self._changed = dict[int, Cell]()

    def run(self) -> None:
        """Compute all cells. Raises UserError if the plan cannot work."""
        end = self._clock() + MOST_SECONDS
        plan = self._request.plan(self._episodes())
        self._atlas = replace(self._atlas, episodes=plan.episodes, impossible=_impossible(plan))
        self._tell(self._atlas)
        with Store.without_file() as store:
            run_sweep(
                plan,
                store,
                on_rows=self._note,
                on_progress=lambda progress: self._report(plan, store, progress),
                is_over=lambda: self._clock() >= end,
            )
            is_done = self._atlas.done == self._atlas.planned
            self._end(plan, store, AtlasState.DONE if is_done else AtlasState.OUT_OF_TIME)

    def _episodes(self) -> int:
        request = self._request
        corners = (
            request.cells.index(corner)
            for corner in product(*({0, count - 1} for count in request.cells.counts))
        )
        lengths = [self._steps_an_episode(index) for index in sorted({request.in_force, *corners})]
        there_is_time_for = MOST_STEPS / (self._atlas.planned * median(lengths))
        return request.episodes if request.episodes <= there_is_time_for else _round_number(there_is_time_for)

    def _steps_an_episode(self, index: int) -> float:
        recipe = self._request.recipe_of(index, self._request.recipe.seed)
        run = Run(recipe, begin(recipe), evaluate=False)
        if was_compiled(run.learner.loop):
            BACKGROUND.read(run.learner.loop)
        run.advance(FIRST_STEPS, self._request.episodes)
        return max(1.0, run.step / max(1, run.learner.episodes))

    def _note(self, cell: Cell, rows: Sequence[RunRow]) -> None:
        self._changed[cell.index] = cell

    def _report(self, plan: SweepPlan, store: Store, progress: SweepProgress) -> None:
        self._atlas = replace(self._atlas, done=progress.done, steps=progress.steps)
        if not self._changed:
            return
        self._take_in(plan, store)
        self._tell(self._atlas)

    def _take_in(self, plan: SweepPlan, store: Store) -> None:
        changed = {index: cell_of(store.rows(cell.key, plan.seeds)) for index, cell in self._changed.items()}
        self._changed.clear()
        cells = {**self._atlas.cells, **changed}
        self._atlas = replace(self._atlas, state=AtlasState.RUNNING, cells=cells)

    def _end(self, plan: SweepPlan, store: Store, state: AtlasState) -> None:
        self._take_in(plan, store)
        self._atlas = replace(
            self._atlas, standings=settled(standings(plan, store), self._atlas.cells, self._request.runs)
        )
        message = (
            ""
            if state is AtlasState.DONE
            else f"the limit of {MOST_SECONDS:.0f} s of processor time was reached"
        )
        self._atlas = replace(self._atlas, state=state, message=message)
        self._tell(self._atlas)


def standings(plan: SweepPlan, store: Store) -> dict[str, AtlasStandings]:
    """Compare the cells of `plan` by each metric with a direction."""
    found = {}
    for name, measure in MEASURES.items():
        if measure.larger_is_better is None:
            continue
        for ranking in standings_of(plan, store, measure).rankings.values():
            if ranking.best is not None:
                alike = frozenset(map(int, ranking.indexes[ranking.alike]))
                found[name] = AtlasStandings(ranking.best.index, alike)
    return found


def settled(
    found: Mapping[str, AtlasStandings], cells: Mapping[int, AtlasCell], runs: int
) -> dict[str, AtlasStandings]:
    """Keep comparisons whose best cell is at least as good as each cell with fewer than `runs` runs."""
    unfinished = [cell for cell in cells.values() if cell.runs < runs]
    return {
        name: each
        for name, each in found.items()
        if not any(_is_better(MEASURES[name], cell, cells[each.best]) for cell in unfinished)
    }


def cell_of(rows: Iterable[RunRow]) -> AtlasCell:
    """Summarize the `rows` of one cell."""
    summary = summarized(rows)
    figures: dict[str, dict[str, Any]] = {
        name: {each: value for each, value in found.items() if each in _FIGURES}
        for name, found in summary.figures.items()
        if found["count"]
    }
    return AtlasCell(summary.runs, summary.failed, figures, summary.first_failure)


def _is_better(measure: Measure, one: AtlasCell, other: AtlasCell) -> bool:
    first, second = one.value(measure), other.value(measure)
    if first is None or second is None:
        return False
    return first > second if measure.larger_is_better else first < second


def _impossible(plan: SweepPlan) -> dict[int, str]:
    cells = (plan.cell(index) for index in range(plan.count))
    return {cell.index: cell.reason for cell in cells if isinstance(cell, SkippedCell)}


def _round_number(number: float) -> int:
    """Return the largest of 1, 2, 5, 10, 20, … up to `number`."""
    digits = len(str(int(max(1.0, number)))) - 1
    return max(int(each * 10**digits) for each in (1, 2, 5) if each == 1 or each * 10**digits <= number)
