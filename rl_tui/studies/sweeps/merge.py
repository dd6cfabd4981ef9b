"""Merging of stores: each run once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from rl_tui.common.errors import UserError
from rl_tui.studies.sweeps.runs import RunRow
from rl_tui.studies.sweeps.store import Store, StoredCell


@dataclass
class Merged:
    """Numbers of merged rows."""

    new: int = 0
    """Rows added."""
    same: int = 0
    """Rows already there with equal results."""
    kept: int = 0
    """Rows with different results on another kind of machine. The first ones are kept."""


def merge(
    out: Path, stores: Sequence[Path], on_progress: Callable[[int, int], None] = lambda done, wanted: None
) -> Merged:
    """Merge `stores` into the store at `out`, which is created if needed.

    Raises UserError, with nothing changed, if a run has two results on one kind of machine.
    """
    for path in stores:
        if path.resolve() == out.resolve():
            raise UserError(f"{path} is the merged store: do not name it as a part too")
        with Store.to_read(path):  # before anything is created
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
                f"results differ from {target.name}, although both machines are of the same kind; leave "
                "out the wrong store"
            )


def _result(row: RunRow) -> tuple[object, ...]:
    return row.failed, *row.figures.values()
