"""Small plans of sweeps, for tests."""

from __future__ import annotations

from typing import Any

from rl_tui.runs.library import find
from rl_tui.studies.sweeps.cell import Cell
from rl_tui.studies.sweeps.cells.variation import read_variation
from rl_tui.studies.sweeps.plan import SweepPlan
from rl_tui.studies.sweeps.store import Store


def plan_of(scenario: str, *vary: str, **settings: Any) -> SweepPlan:
    """Return a plan of 3 runs of 20 episodes, unless ``settings`` differ."""
    variations = tuple(read_variation(text) for text in vary)
    return SweepPlan(find(scenario), variations, **{"episodes": 20, "runs": 3, **settings})


def cell_of(scenario: str, *vary: str, **settings: Any) -> Cell:
    """Return the first cell of such a plan."""
    cell = plan_of(scenario, *vary, **settings).cell(0)
    assert isinstance(cell, Cell), cell
    return cell


def seeds_in(store: Store, plan: SweepPlan) -> dict[int, list[int]]:
    """Return the stored seeds of each valid cell of ``plan``."""
    cells = [plan.cell(index) for index in range(plan.count)]
    return {
        cell.index: [row.seed for row in store.rows(cell.key, plan.seeds)]
        for cell in cells
        if isinstance(cell, Cell)
    }
