"""Small plans of sweeps, for tests."""

from __future__ import annotations

import io
from typing import Any

from rl_tui.runs.library import find
from rl_tui.studies.sweeps.cell import Cell
from rl_tui.studies.sweeps.cells.variation import read_variation
from rl_tui.studies.sweeps.document import write_csv
from rl_tui.studies.sweeps.plan import SweepPlan
from rl_tui.studies.sweeps.store import Store


def plan_of(scenario: str, *vary: str, **settings: Any) -> SweepPlan:
    variations = tuple(read_variation(text) for text in vary)
    return SweepPlan(find(scenario), variations, **{"episodes": 20, "runs": 3, **settings})


def cell_of(scenario: str, *vary: str, **settings: Any) -> Cell:
    cell = plan_of(scenario, *vary, **settings).cell(0)
    assert isinstance(cell, Cell), cell
    return cell


def seeds_in(store: Store, plan: SweepPlan) -> dict[int, list[int]]:
    cells = [plan.cell(index) for index in range(plan.count)]
    return {
        cell.index: [row.seed for row in store.rows(cell.key, plan.seeds)]
        for cell in cells
        if isinstance(cell, Cell)
    }


def csv_of(plan: SweepPlan, store: Store) -> str:
    stream = io.StringIO()
    write_csv(stream, plan, store)
    return stream.getvalue()
