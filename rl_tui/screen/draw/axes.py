"""The axes of a chart."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Final

from rl_tui.screen.draw.canvas import Canvas
from rl_tui.screen.draw.chart_plot import Plot
from rl_tui.screen.draw.scale import Scale, tick_label, tick_step
from rl_tui.screen.theme.look import Look

_LEAST_LABEL: Final = 3
_LEAST_APART: Final = 2  # rows between two labels at the left; from there on uneven gaps hardly show
_GAP: Final = 2  # columns between two labels below


def value_axis_columns(scale: Scale, look: Look) -> int:
    """Return the columns of the vertical axis."""
    return 1 + max(_LEAST_LABEL, *(len(tick_label(each, scale.step, look.glyphs)) for each in scale.ticks))


def draw_value_axis(canvas: Canvas, plot: Plot, look: Look) -> None:
    """Draw the vertical axis, with inner labels if evenly spaced."""
    glyphs, style = look.glyphs, look.palette.dim
    axis = plot.left - 1
    for row in range(plot.rows):
        canvas.put(axis, row, glyphs.axis_vertical, style)
    for value in _labelled(plot):
        text = tick_label(value, plot.scale.step, glyphs) + glyphs.axis_tick
        canvas.put(plot.left - len(text), plot.row(value), text, style)


def _labelled(plot: Plot) -> list[float]:
    ticks = plot.scale.ticks
    rows = [plot.row(value) for value in ticks]
    apart = [lower - upper for lower, upper in pairwise(rows)]
    if min(apart) >= _LEAST_APART and (max(apart) == min(apart) or min(apart) > _LEAST_APART):
        return ticks
    low, high = ticks[0], ticks[-1]
    ends = [low, high] if rows[0] != rows[-1] else [low]
    has_zero = low < 0.0 < high and min(rows[0] - plot.row(0.0), plot.row(0.0) - rows[-1]) >= _LEAST_APART
    return [*ends, 0.0] if has_zero else ends


def draw_count_axis(
    canvas: Canvas, plot: Plot, last: float, most: int, unit: str, look: Look, step: float | None = None
) -> None:
    """Draw the horizontal axis with up to ``most`` labels, or one per ``step``."""
    glyphs, style = look.glyphs, look.palette.dim
    canvas.put(plot.left - 1, plot.rows, glyphs.axis_corner + glyphs.axis_horizontal * plot.columns, style)
    place = min(plot.left + plot.columns, canvas.width - len(unit))
    canvas.put(place, plot.rows, unit, style)
    free, end = 0, min(plot.columns, place - plot.left)  # the unit begins with a blank
    step = step or tick_step(last, most)
    for number in range(int(last / step + 1e-9) + 1):
        short = tick_label(number * step, step, glyphs)
        text, column = f"{int(short):,}" if short.isdigit() else short, plot.column(number * step)
        # The last label may touch the end, where only its left half would fit
        start = min(max(0, column - len(text) // 2), end - len(text) if column <= end else column)
        if start >= free and start + len(text) <= end:
            canvas.put(plot.left + start, plot.rows, text, style)
            free = start + len(text) + _GAP


# The rows of labels beside the ends of lines


def apart(wanted: Sequence[int], rows: int) -> list[int]:
    """Return a separate row for each of ``wanted`` (ascending), with the fewest moves."""
    reach = len(wanted)
    placed: dict[int, tuple[int, tuple[int, ...]]] = {-1: (0, ())}  # by the row of the last: moves, rows
    for row in wanted:
        placed = {
            place: min(
                (moves + abs(place - row), (*above, place))
                for last, (moves, above) in placed.items()
                if last < place
            )
            for place in range(max(0, row - reach), min(rows, row + reach + 1))
            if place > min(placed)
        }
    return list(min(placed.values())[1])
