"""Where on the curve the world became another one: a mark on the axis, and a line upwards from it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final, NamedTuple

from rich.style import Style

from rl_tui.runs.run import WorldChanged
from rl_tui.screen.draw.canvas import Canvas
from rl_tui.screen.draw.chart_plot import Plot
from rl_tui.screen.kit.panel import LegendSign
from rl_tui.screen.theme.look import Look

_APART: Final = 3  # columns from one mark to the next: changes that are closer share one
_COLUMNS_A_LINE: Final = 8  # of more marks the lines would hide the curve


class WorldMark(NamedTuple):
    """One change of the world, or several close together, at a ``column`` of the plot, from 0.

    ``has_given_up`` says that by one of them an episode was given up.
    """

    column: int
    has_given_up: bool

    def sign(self, look: Look) -> tuple[str, Style]:
        """Return its sign."""
        glyphs = look.glyphs
        return glyphs.given_up_mark if self.has_given_up else glyphs.world_mark, look.palette.strong


def world_marks(changes: Sequence[WorldChanged], plot: Plot) -> list[WorldMark]:
    """Return the marks of ``changes``, which are in order, from left to right."""
    marks: list[WorldMark] = []
    for change in changes:
        column = min(plot.column(change.episodes), plot.columns - 1)
        if marks and column - marks[-1].column < _APART:
            marks[-1] = marks[-1]._replace(has_given_up=marks[-1].has_given_up or change.given_up)
        else:
            marks.append(WorldMark(column, change.given_up))
    return marks


def lines_of(marks: Sequence[WorldMark], plot: Plot) -> list[int]:
    """Return the columns in which a line goes up from a mark; none where there are too many."""
    return [each.column for each in marks] if len(marks) * _COLUMNS_A_LINE <= plot.columns else []


def draw_marks(canvas: Canvas, marks: Sequence[WorldMark], plot: Plot, look: Look) -> None:
    """Put the marks on the horizontal axis; where a number stands there, above it."""
    for mark in marks:
        x = plot.left + mark.column
        is_number = canvas.at(x, plot.rows) != look.glyphs.axis_horizontal
        canvas.put(x, plot.rows - is_number, *mark.sign(look))


def world_signs(changes: Sequence[WorldChanged], look: Look) -> Iterator[LegendSign]:
    """Yield what the marks mean, as far as there are any."""
    given_up = {change.given_up for change in changes}
    for has_given_up, meaning in ((False, "new world"), (True, "new world, episode given up")):
        if has_given_up in given_up:
            sign, style = WorldMark(0, has_given_up).sign(look)
            yield LegendSign(sign, meaning, style)
