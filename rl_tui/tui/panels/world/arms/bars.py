"""The bars of a bandit's arms, a pure function of what is known about them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Final, NamedTuple

from rich.cells import cell_len
from rich.style import Style
from textual.strip import Strip

from rl_tui.tui.draw import numbers
from rl_tui.tui.draw.canvas import Canvas, shortened
from rl_tui.tui.draw.number_form import NumberForm
from rl_tui.tui.draw.to_ascii import to_ascii
from rl_tui.tui.panels.world.arms.scale import ArmsScale, bound_text, ticks
from rl_tui.tui.theme.look import Look

NOT_PULLED: Final = ("not pulled yet", "not pulled")  # the longest first
_MOST_NAME: Final = 12
_LEAST_PLOT: Final = 10
_VALUES_FROM: Final = 76  # from this width on estimate and pulls are written beside the bars
_VALUES_WIDTH: Final = 18
_VALUE: Final = 6  # cells of an estimate
_LEAST_VALUE: Final = 3


class Arm(NamedTuple):
    """One arm. ``error`` is None before its first pull, ``mean`` None while the truth is hidden.

    ``cursor`` marks the arm the cursor stands on, ``stops`` a breakpoint.
    """

    name: str
    estimate: float
    error: float | None
    pulls: int
    greedy: bool
    last: bool
    mean: float | None
    best: bool
    cursor: bool = False
    stops: bool = False

    def extent(self) -> Iterator[float]:
        """Yield the values that the scale has to hold."""
        if self.error is not None:
            yield self.estimate - self.error
            yield self.estimate + self.error
        if self.mean is not None:
            yield self.mean


class _Plot(NamedTuple):
    """The columns of the bars: ``left`` … ``left + width − 1`` stand for the ends of ``scale``."""

    left: int
    width: int
    scale: ArmsScale

    def column(self, value: float) -> int:
        low, high = self.scale
        inside = min(max(value, low), high) if not math.isnan(value) else 0.0
        return self.left + round((inside - low) / (high - low) * (self.width - 1))


def rows_an_arm(arms: int, height: int) -> int:
    """Return 2 where every arm and the axis fit with a blank row between, else 1."""
    return 2 if 2 * arms + 1 <= height else 1


def true_mean_glyph(look: Look) -> str:
    """Return the mark of a true mean."""
    return "x" if look.glyphs.name == "ascii" else "◆"


def names_width(arms: Sequence[Arm], look: Look) -> int:
    """Return the cells that the names of ``arms`` take."""
    return min(_MOST_NAME, max((cell_len(to_ascii(arm.name, look.glyphs)) for arm in arms), default=0))


def value_width(width: int, names: int) -> int:
    """Return the cells that an estimate gets in a panel of ``width`` cells with ``names`` cells of names."""
    return _VALUE if width >= _VALUES_FROM else max(_LEAST_VALUE, min(_VALUE, width - names - 3))


def draw_arms(
    arms: Sequence[Arm],
    scale: ArmsScale,
    look: Look,
    width: int,
    height: int,
    each: int,
    names: int,
    form: NumberForm,
) -> list[Strip]:
    """Return the bars of ``arms``, ``each`` rows an arm, and below them the axis where a row is left.

    A row: ▸ where greedy, ◉ where pulled last, the name, a breakpoint, the bar; the best arm has a ★ at the
    end once the truth is shown. Names get ``names`` cells; estimates are in ``form``.
    """
    glyphs, palette = look.glyphs, look.palette
    canvas = Canvas(width, height, palette.text)
    left, right = 2 + names + 1, _VALUES_WIDTH if width >= _VALUES_FROM else 2
    plot = _Plot(left, width - left - right, scale)
    for index, arm in enumerate(arms):
        _draw_head(canvas, index * each, arm, names, look)
        if plot.width >= _LEAST_PLOT:
            for y in range(index * each, min(height, (index + 1) * each)):
                canvas.put(plot.column(0.0), y, glyphs.zero_line, palette.dim)
            _draw_bar(canvas, index * each, arm, plot, look, form)
        else:
            _draw_value(canvas, index * each, arm, left, look, form)
    axis = len(arms) * each
    if axis < height and plot.width >= _LEAST_PLOT:
        _draw_axis(canvas, axis, plot, look)
    return canvas.strips()


def _draw_head(canvas: Canvas, y: int, arm: Arm, names: int, look: Look) -> None:
    glyphs, palette = look.glyphs, look.palette
    if arm.greedy:
        canvas.put(0, y, glyphs.cursor, palette.greedy)
    if arm.last:
        canvas.put(1, y, glyphs.agent, palette.agent)
    name = shortened(to_ascii(arm.name, glyphs), names, glyphs.ellipsis)
    style = palette.focus if arm.cursor else palette.greedy if arm.greedy else palette.text
    canvas.put(2 + names - cell_len(name), y, name, style)
    if arm.stops:
        canvas.put(2 + names, y, glyphs.breakpoint, palette.breakpoint)


def _draw_bar(canvas: Canvas, y: int, arm: Arm, plot: _Plot, look: Look, form: NumberForm) -> None:
    glyphs, palette = look.glyphs, look.palette
    if arm.error is None:
        _draw_not_pulled(canvas, y, arm, plot, look)
    else:
        first, last = plot.column(arm.estimate - arm.error), plot.column(arm.estimate + arm.error)
        style = palette.greedy if arm.greedy else palette.text
        canvas.put(first, y, glyphs.whisker * (last - first + 1), style)
        canvas.put(plot.column(arm.estimate), y, glyphs.estimate, style)
    if arm.mean is not None:
        canvas.put(plot.column(arm.mean), y, true_mean_glyph(look), palette.optimum + Style(bold=True))
    if arm.best:
        canvas.put(plot.left + plot.width + 1, y, glyphs.best_arm, palette.optimum + Style(bold=True))
    if canvas.width >= _VALUES_FROM and arm.error is not None:
        text = f"{form.text(arm.estimate, glyphs):>{_VALUE}}{numbers.count(arm.pulls, 7):>8}"
        canvas.put(canvas.width - len(text) - 1, y, text, palette.dim)


def _draw_not_pulled(canvas: Canvas, y: int, arm: Arm, plot: _Plot, look: Look) -> None:
    """Say so where the true mean is not: before or behind its mark, nothing where there is no room."""
    end = plot.left + plot.width
    mark = end + 1 if arm.mean is None else plot.column(arm.mean)
    for text in NOT_PULLED:
        for start, behind in ((plot.left, min(end, mark - 1)), (mark + 2, end)):
            if start + len(text) <= behind:
                canvas.put(start, y, text, look.palette.dim)
                return


def _draw_value(canvas: Canvas, y: int, arm: Arm, left: int, look: Look, form: NumberForm) -> None:
    """Write the estimate where a bar would have no room."""
    if canvas.width - left < _LEAST_VALUE:
        return
    text = look.glyphs.ellipsis if arm.error is None else form.text(arm.estimate, look.glyphs)
    canvas.put(left, y, text, look.palette.greedy if arm.greedy else look.palette.text)


def _draw_axis(canvas: Canvas, y: int, plot: _Plot, look: Look) -> None:
    """Write round values below their columns, as many as keep apart."""
    end = -1
    for value in ticks(plot.scale, max(2, plot.width // 10)):
        text = bound_text(value, look.glyphs)
        x = min(plot.column(value) - len(text) // 2, canvas.width - len(text))
        if x > end:
            canvas.put(x, y, text, look.palette.dim)
            end = x + len(text)
