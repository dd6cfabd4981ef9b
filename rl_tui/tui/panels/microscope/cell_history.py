"""The history of one cell under its heading, or why there is none."""

from __future__ import annotations

from itertools import groupby
from typing import Final

import numpy as np
from textual.strip import Strip

from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.lab.timeline.table_samples import CellHistory
from rl_tui.tui.draw import braille, names
from rl_tui.tui.draw.axes import draw_count_axis, draw_value_axis, value_axis_columns
from rl_tui.tui.draw.braille import Steps
from rl_tui.tui.draw.canvas import Canvas
from rl_tui.tui.draw.chart_plot import Plot
from rl_tui.tui.draw.number_form import number_form
from rl_tui.tui.draw.pieces import wrapped
from rl_tui.tui.draw.scale import round_range, round_scale
from rl_tui.tui.panels.microscope.section import MicroscopeSection, columns_of, stacked
from rl_tui.tui.panels.q_table.layers import exact_q
from rl_tui.tui.panels.snapshot_facts import is_secret, keeps_back
from rl_tui.tui.theme.look import Look

HISTORY: Final = "History"
COMING: Final = "comes with the next picture"
NO_CELL: Final = "no cell was updated yet: the table's cursor chooses one"
NOT_KEPT: Final = "of a table as large as this no history is kept"
LEAST_HEIGHT: Final = 4
_LEAST_WIDTH: Final = 16
_TICK_COLUMNS: Final = 9
_VALUE_COLUMNS: Final = 7
_UNIT: Final = " step"
# What stands for a cell of which the line takes neither half, the upper one, the lower one, both
_HALVES: Final = np.array([ord(each) for each in " '.:"])


def history_strips(snapshot: Snapshot, pair: int | None, look: Look, width: int, height: int) -> list[Strip]:
    """Return how the estimate of ``pair`` went, in ``height`` rows, heading included.

    The exact value is shown where it is known and not hidden.
    """
    rows = height - 1
    if pair is None:
        return _instead(NO_CELL, HISTORY, (), look, width, rows)
    known = exact_q(snapshot)
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
    """Return the value now and the exact one, with as many decimals, longest form first."""
    q = float(snapshot.agent.q[pair])
    form = number_form([q] if exact is None else [q, exact], _VALUE_COLUMNS)
    now = form.text(q, look.glyphs) if snapshot.agent.holds(pair) else look.glyphs.ellipsis
    if exact is None and is_secret(snapshot) and not snapshot.exact_answer.refused:
        key = () if keeps_back(snapshot, "answer") else (f"now {now}, h shows the exact",)
        return *key, f"now {now}"
    if exact is None:
        return (f"now {now}",)
    return f"now {now}, exact {form.text(exact, look.glyphs)}", f"now {now}"


def _is_kept(cell: CellHistory) -> bool:
    return not cell.step[0]


def _instead(
    text: str, heading: str, values: tuple[str, ...], look: Look, width: int, rows: int
) -> list[Strip]:
    lines = wrapped(text, width, look.palette.dim, look, " ", " ")
    return stacked([MicroscopeSection(heading, lines, rows, values)], look, width)


def draw_history(cell: CellHistory, exact: float | None, look: Look, width: int, height: int) -> list[Strip]:
    """Return ``height`` strips of ``width`` cells; ``exact`` is None where it is not known, or secret.

    The value holds from the step after which it was reached to the next one in the history.
    """
    canvas = Canvas(width, height, look.palette.text)
    if width < _LEAST_WIDTH or height < LEAST_HEIGHT or not len(cell.step):
        return canvas.strips()
    finite = cell.value[np.isfinite(cell.value)]
    known = [
        *([] if exact is None else [exact]),
        *([float(finite.min()), float(finite.max())] if len(finite) else [0.0]),
    ]
    scale, last = round_scale(min(known), max(known)), float(cell.step[-1])
    left = 1 + value_axis_columns(scale, look)
    plot = Plot(left, width - left, height - 1, round_range(last), scale)
    draw_value_axis(canvas, plot, look)
    draw_count_axis(canvas, plot, plot.right, plot.columns // _TICK_COLUMNS, _UNIT, look)
    if exact is not None:
        dots = look.glyphs.level if look.glyphs.braille else f"{look.glyphs.level} "
        canvas.put(plot.left, plot.row(exact), (dots * plot.columns)[: plot.columns], look.palette.optimum)
    _draw_line(canvas, plot, cell, look)
    return canvas.strips()


def _draw_line(canvas: Canvas, plot: Plot, cell: CellHistory, look: Look) -> None:
    """Draw the estimate over what is there."""
    begins = cell.step.astype(np.float64)
    steps = Steps(begins, np.append(begins[1:], begins[-1]), cell.value, cell.value)
    codes = plot.braille_line(steps) if look.glyphs.braille else _HALVES[plot.halves(steps)]
    blank = braille.BLANK if look.glyphs.braille else ord(" ")
    for row, line in enumerate(codes.tolist()):
        start = 0
        for is_blank, cells in groupby(line, blank.__eq__):
            text = "".join(map(chr, cells))
            if not is_blank:
                canvas.put(plot.left + start, row, text, look.palette.episodes)
            start += len(text)
