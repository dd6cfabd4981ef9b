"""How the estimate of one pair went, step by step, with its exact value as a line."""

from __future__ import annotations

from itertools import groupby
from typing import Final

import numpy as np
import numpy.typing as npt
from textual.strip import Strip

from rl_tui.lab.snapshot import CellHistory
from rl_tui.tui.canvas import Canvas
from rl_tui.tui.theme.look import Look
from rl_tui.tui.widgets import braille
from rl_tui.tui.widgets.braille import Steps
from rl_tui.tui.widgets.scale import Scale, round_scale, tick_label, tick_step

LEAST_HEIGHT: Final = 4
_LEAST_WIDTH: Final = 16
_TICK_COLUMNS: Final = 9
_UNIT: Final = " step"


def draw_history(cell: CellHistory, exact: float | None, look: Look, width: int, height: int) -> list[Strip]:
    """Return ``height`` strips of ``width`` cells; ``exact`` is None where it is not known, or secret.

    The value holds from the step after which it was reached to the next one that is told.
    """
    canvas = Canvas(width, height, look.palette.text)
    if width < _LEAST_WIDTH or height < LEAST_HEIGHT or not len(cell.step):
        return canvas.strips()
    finite = cell.value[np.isfinite(cell.value)]
    known = [
        *([] if exact is None else [exact]),
        *([float(finite.min()), float(finite.max())] if len(finite) else [0.0]),
    ]
    scale = round_scale(min(known), max(known))
    ticks = [tick_label(each, scale.step, look.glyphs) for each in scale.ticks]
    left = max(3, *map(len, ticks)) + 2
    plot = _Plot(left, width - left, height - 1, float(max(1, cell.step[-1])), scale)
    plot.draw_axes(canvas, ticks, look)
    if exact is not None:
        plot.draw_level(canvas, exact, look)
    plot.draw_line(canvas, cell, look)
    return canvas.strips()


class _Plot:
    """Where the curve is: from column ``left``, ``columns`` × ``rows`` cells, steps 0 .. ``right``."""

    def __init__(self, left: int, columns: int, rows: int, right: float, scale: Scale) -> None:
        self.left = left
        self.columns = columns
        self.rows = rows
        self.right = right
        self.scale = scale

    def row(self, value: float) -> int:
        """Return the row of ``value``, placed as dots are."""
        last = self.rows * braille.DOTS_DOWN - 1
        share = (self.scale.high - value) / (self.scale.high - self.scale.low)
        return min(max(round(share * last), 0), last) // braille.DOTS_DOWN

    def draw_axes(self, canvas: Canvas, ticks: list[str], look: Look) -> None:
        """Draw both axes: values at the left, steps below."""
        glyphs, style = look.glyphs, look.palette.dim
        axis = self.left - 1
        for row in range(self.rows):
            canvas.put(axis, row, glyphs.axis_vertical, style)
        for value, text in zip(self.scale.ticks, ticks, strict=True):
            canvas.put(axis - len(text), self.row(value), text, style)
            canvas.put(axis, self.row(value), glyphs.axis_tick, style)
        canvas.put(axis, self.rows, glyphs.axis_corner + glyphs.axis_horizontal * self.columns, style)
        canvas.put(self.left + self.columns - len(_UNIT), self.rows, _UNIT, style)
        step = tick_step(self.right, self.columns // _TICK_COLUMNS)
        free, end = 0, self.columns - len(_UNIT) - 1
        for number in range(int(self.right / step) + 1):
            text = tick_label(number * step, step, glyphs)
            start = max(0, int(number * step / self.right * self.columns) - len(text) // 2)
            if free <= start and start + len(text) <= end:
                canvas.put(self.left + start, self.rows, text, style)
                free = start + len(text) + 2

    def draw_level(self, canvas: Canvas, exact: float, look: Look) -> None:
        """Draw the line of the exact value."""
        dots = look.glyphs.level if look.glyphs.braille else f"{look.glyphs.level} "
        text = (dots * self.columns)[: self.columns]
        canvas.put(self.left, self.row(exact), text, look.palette.optimum)

    def draw_line(self, canvas: Canvas, cell: CellHistory, look: Look) -> None:
        """Draw the estimate over what is there."""
        codes = self._dots(cell) if look.glyphs.braille else self._characters(cell)
        blank = braille.BLANK if look.glyphs.braille else ord(" ")
        for row, line in enumerate(codes.tolist()):
            start = 0
            for is_blank, cells in groupby(line, blank.__eq__):
                text = "".join(map(chr, cells))
                if not is_blank:
                    canvas.put(self.left + start, row, text, look.palette.episodes)
                start += len(text)

    def _span(self, cell: CellHistory, columns: int, rows: int) -> npt.NDArray[np.bool_]:
        start = cell.step.astype(np.float64)
        end = np.append(start[1:], self.right)
        low, high = braille.decimated(Steps(start, end, cell.value, cell.value), self.right, columns)
        line = braille.joined(braille.span(low, high, self.scale.low, self.scale.high, rows))
        return braille.dots_of(line, rows)

    def _dots(self, cell: CellHistory) -> npt.NDArray[np.int64]:
        dots = self._span(cell, self.columns * braille.DOTS_ACROSS, self.rows * braille.DOTS_DOWN)
        return braille.braille_codes(dots)

    def _characters(self, cell: CellHistory) -> npt.NDArray[np.int64]:
        """Return ``'`` ``.`` ``:`` for the upper and lower half of each cell of the line."""
        dots = self._span(cell, self.columns, self.rows * 2).astype(np.int64)
        return np.asarray(np.array([ord(" "), ord("'"), ord("."), ord(":")])[dots[::2] + 2 * dots[1::2]])
