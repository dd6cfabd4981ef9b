"""Puts stores together: each row once, and the same figures wherever a row stands in two of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from rl_tui.common.errors import UserError
from rl_tui.studies.sweeps.runs import RunRow
from rl_tui.studies.sweeps.store import Store, StoredCell


@dataclass
class Merged:
    """What came of putting stores together."""

    new: int = 0
    """Rows that were added."""
    same: int = 0
    """Rows that were there already, with the same figures."""
    kept: int = 0
    """Rows that another kind of machine gave other figures: the first one stands."""


def merge(
    out: Path, stores: Sequence[Path], on_progress: Callable[[int, int], None] = lambda done, wanted: None
) -> Merged:
    """Add the rows of ``stores`` to the one at ``out``, which is made where there is none.

    Raises UserError where one of them is no store, or where a run has two different results on one kind of
    machine; what was added until then is left as it was before.
    """
    for path in stores:
        if path.resolve() == out.resolve():
            raise UserError(f"{path} is what is merged into: name it once")
        with Store.to_read(path):  # before anything is made
            pass
    merged = Merged()
    with Store.to_write(out) as target:
        try:
            for number, path in enumerate(stores):
                on_progress(number, len(stores))
                with Store.to_read(path) as source:
                    for plan in source.plans():
                        target.note_plan(plan)
                    for cell in source.cells():
                        _take_in(target, source, cell, merged)
            on_progress(len(stores), len(stores))
        except BaseException:
            target.roll_back()
            raise
    return merged


def _take_in(target: Store, source: Store, cell: StoredCell, merged: Merged) -> None:
    known = {row.seed: (machine, row) for machine, row in target.rows_by_machine(cell.key)}
    for machine, row in source.rows_by_machine(cell.key):
        if row.seed not in known:
            merged.new += target.add(cell, [row], machine)
            continue
        machine_before, before = known[row.seed]
        if _result(before) == _result(row):
            merged.same += 1
        elif machine_before != machine:
            merged.kept += 1
        else:
            raise UserError(
                f"{source.name}: cell {cell.key[:12]} ({cell.scenario} {cell.settings}), seed {row.seed}: "
                f"other figures than in {target.name}, from the same kind of machine; one of the two is wrong"
            )


def _result(row: RunRow) -> tuple[object, ...]:
    return row.failed, *row.figures.values()
