"""Where a cell is once rows or columns of the map were added or taken away."""

from __future__ import annotations

from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.worlds.drawing import Grid
from rl_tui.worlds.editing.grid_draft import GridDraft


def carried_place(place: int, before: Snapshot, now: Snapshot) -> tuple[int, int, int]:
    """Return the cell of ``now`` that was ``place`` in ``before``, and how far down and right it has gone.

    Where its row or column is gone, or nobody draws, it is the one at the same row and column, or the last.
    """
    was, grid = before.world.drawing, now.world.drawing
    assert isinstance(was, Grid)
    assert isinstance(grid, Grid)
    was_row, was_column = row, column = divmod(place, was.columns)
    old, new = before.editor.base, now.editor.base
    if isinstance(old, GridDraft) and isinstance(new, GridDraft):
        row = _line(row, old.row_ids, new.row_ids)
        column = _line(column, old.column_ids, new.column_ids)
    row, column = min(row, grid.rows - 1), min(column, grid.columns - 1)
    return row * grid.columns + column, row - was_row, column - was_column


def _line(line: int, old: tuple[int, ...], new: tuple[int, ...]) -> int:
    wanted = old[line] if line < len(old) else None
    return new.index(wanted) if wanted in new else line
