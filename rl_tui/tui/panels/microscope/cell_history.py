"""The history of one cell under its heading, or why there is none."""

from __future__ import annotations

from typing import Final

from textual.strip import Strip

from rl_tui.lab.live.snapshot import CellHistory, Snapshot
from rl_tui.tui.draw import names, numbers
from rl_tui.tui.draw.pieces import wrapped
from rl_tui.tui.panels.microscope.cell_curve import draw_history
from rl_tui.tui.panels.microscope.section import MicroscopeSection, columns_of, stacked
from rl_tui.tui.panels.q_table.layers import exact_q
from rl_tui.tui.theme.look import Look

HISTORY: Final = "History"
COMING: Final = "comes with the next picture"
NO_CELL: Final = "no cell was updated yet: the table's cursor chooses one"
NOT_KEPT: Final = "of a table as large as this no history is kept"


def history_strips(
    snapshot: Snapshot, pair: int | None, look: Look, width: int, height: int, *, revealed: bool
) -> list[Strip]:
    """Return how the estimate of ``pair`` went, in ``height`` rows, heading included.

    The exact value is told where it is known; ``revealed`` tells that of a bandit as well.
    """
    rows = height - 1
    if pair is None:
        return _instead(NO_CELL, HISTORY, (), look, width, rows)
    known = exact_q(snapshot, revealed)
    exact = None if known is None else float(known[0][pair])
    values = _values_text(snapshot, pair, exact, look)
    name = f"Q({names.pair_name(snapshot.world, pair, look.glyphs)})"
    heading = f"{HISTORY} of {name}"
    if columns_of(f" {heading}  {values[0]} ", look) > width:
        heading = name
    cell = snapshot.cell
    if cell is None or cell.pair != pair:
        return _instead(COMING, heading, values, look, width, rows)
    if not _is_kept(cell):
        return _instead(NOT_KEPT, heading, values, look, width, rows)
    head = stacked([MicroscopeSection(heading, [], 0, values)], look, width)
    return [*head, *draw_history(cell, exact, look, width, rows)]


def _values_text(snapshot: Snapshot, pair: int, exact: float | None, look: Look) -> tuple[str, ...]:
    """Return the value now and the exact one, longest form first."""
    now = look.glyphs.ellipsis
    if snapshot.holds(pair):
        now = numbers.value(float(snapshot.q[pair]), 7, look.glyphs)
    if exact is None:
        return (f"now {now}",)
    return f"now {now}, exact {numbers.value(exact, 7, look.glyphs)}", f"now {now}"


def _is_kept(cell: CellHistory) -> bool:
    return not cell.step[0]


def _instead(
    text: str, heading: str, values: tuple[str, ...], look: Look, width: int, rows: int
) -> list[Strip]:
    lines = wrapped(text, width, look.palette.dim, look, " ", " ")
    return stacked([MicroscopeSection(heading, lines, rows, values)], look, width)
