"""The raw results of a sweep as CSV: one row a run, the same bytes however they were come by."""

from __future__ import annotations

import csv
from typing import TextIO

from rl_tui.studies.sweeps.cell import Cell
from rl_tui.studies.sweeps.cells.variation import written
from rl_tui.studies.sweeps.plan import SweepPlan
from rl_tui.studies.sweeps.schema import FIGURES
from rl_tui.studies.sweeps.store import Store


def write_csv(stream: TextIO, plan: SweepPlan, store: Store) -> None:
    """Write what ``store`` has of ``plan``: the settings, the seed, every figure, and why a run failed.

    Rows stand by the order of the plan and then by seed, without times or places.
    """
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow([*plan.names, "seed", *FIGURES, "failed"])
    for index in range(plan.count):
        cell = plan.cell(index)
        if not isinstance(cell, Cell):
            continue
        settings = [written(value) for value in cell.settings.values()]
        for row in store.rows(cell.key, plan.seeds):
            figures = ("" if each is None else repr(each) for each in map(row.figures.get, FIGURES))
            writer.writerow([*settings, row.seed, *figures, row.failed or ""])
