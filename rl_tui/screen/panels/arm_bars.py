"""Bars of a bandit's arms with standard errors."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache
from typing import Final, NamedTuple

from rich.cells import cell_len
from rich.color import ColorType
from rich.style import Style

from rl_tui.screen.draw import numbers
from rl_tui.screen.draw.canvas import Canvas, shortened
from rl_tui.screen.draw.number_form import NumberForm
from rl_tui.screen.draw.scale import round_step
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.screen.theme.look import Look
from rl_tui.screen.theme.roles import Palette, faded

# The axis


_STEPS: Final = (1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)


class ArmsScale(NamedTuple):
    """An axis with low ≤ 0 ≤ high."""

    low: float
    high: float


NO_SCALE: Final = ArmsScale(0.0, 0.0)


def grown(scale: ArmsScale, values: Iterable[float]) -> ArmsScale:
    """Widen to round ends around finite ``values``."""
    low, high = scale
    for value in values:
        if math.isfinite(value):
            low = min(low, -round_up(-value)) if value < low else low
            high = max(high, round_up(value)) if value > high else high
    return ArmsScale(low, high)


def shown_scale(scale: ArmsScale) -> ArmsScale:
    """Return the scale, −1 … 1 without values."""
    return scale if scale.low < scale.high else ArmsScale(-1.0, 1.0)


def round_up(value: float) -> float:
    """Return the next of 1, 2, 3, 4, 5, 6, 8 times a power of ten."""
    power = 10.0 ** math.floor(math.log10(value))
    # 3 × 0.1 is not 0.3
    ends = (float(f"{step * power:.3g}") for step in _STEPS)
    return next((end for end in ends if value <= end), 10.0 * power)


def ticks(scale: ArmsScale, most: int) -> list[float]:
    """Return about ``most`` round values, including 0."""
    span = scale.high - scale.low
    step = round_step(span / max(1, most - 1))
    first, last = math.ceil(scale.low / step - 1e-9), math.floor(scale.high / step + 1e-9)
    return [index * step for index in range(first, last + 1)]


def bound_text(value: float, glyphs: Glyphs) -> str:
    """Write a round value in the fewest characters."""
    return f"{value:.6g}".replace("-", glyphs.minus) if value else "0"


# The bars


NOT_PULLED: Final = ("not pulled yet", "not pulled")  # longest first
_MOST_NAME: Final = 12
_LEAST_PLOT: Final = 10
_VALUES_FROM: Final = 56  # from this width on, estimate and pulls are written beside the bars
_SHARES_FROM: Final = 84  # from this width on, also the share of all pulls
_VALUE: Final = 6  # cells of an estimate
_PULLS: Final = 8
_SHARE: Final = 7
_LEAST_VALUE: Final = 3
_AROUND_NAME: Final = 4  # its marks and a blank before it, a blank after it
_MOST_ROWS: Final = 3  # rows per arm
_DEPTH: Final = 0.55  # colour strength of all bars but the best


class Arm(NamedTuple):
    """One arm. ``error``: None before its first pull. ``mean``: None while hidden."""

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
        """Yield the values that the scale must contain."""
        if self.error is not None:
            yield self.estimate - self.error
            yield self.estimate + self.error
        if self.mean is not None:
            yield self.mean


class _Plot(NamedTuple):
    left: int
    width: int
    scale: ArmsScale

    def column(self, value: float) -> int:
        low, high = self.scale
        inside = min(max(value, low), high) if not math.isnan(value) else 0.0
        return self.left + round((inside - low) / (high - low) * (self.width - 1))


def rows_an_arm(arms: int, height: int) -> int:
    """Return 1 to 3 rows per arm."""
    return max(1, min(_MOST_ROWS, (height - 1) // arms))


def true_mean_glyph(look: Look) -> str:
    """Return the mark of a true mean."""
    return "x" if look.glyphs.name == "ascii" else "◆"


def names_width(arms: Sequence[Arm], look: Look) -> int:
    """Measure the longest name."""
    return min(_MOST_NAME, max((cell_len(look.glyphs.spelled(arm.name)) for arm in arms), default=0))


def value_width(width: int, names: int) -> int:
    """Return the columns for an estimate."""
    return _VALUE if width >= _VALUES_FROM else max(_LEAST_VALUE, min(_VALUE, width - names - _AROUND_NAME))


def _beside(width: int) -> int:
    if width < _VALUES_FROM:
        return 2
    return 2 + _VALUE + _PULLS + (_SHARE if width >= _SHARES_FROM else 0)


def draw_arms(
    canvas: Canvas, arms: Sequence[Arm], scale: ArmsScale, look: Look, each: int, names: int, form: NumberForm
) -> None:
    """Draw bars of ``each`` rows, and the axis if it fits. ▸ greedy, ◉ last pull, ★ revealed best arm."""
    glyphs, palette, width, height = look.glyphs, look.palette, canvas.width, canvas.height
    left = names + _AROUND_NAME
    plot = _Plot(left, width - left - _beside(width), scale)
    total = sum(arm.pulls for arm in arms)
    for index, arm in enumerate(arms):
        top = index * each
        rows = range(top, min(height, top + max(1, each - 1)))
        _draw_head(canvas, top, arm, names, look)
        if plot.width >= _LEAST_PLOT:
            for y in range(top, min(height, top + each)):
                canvas.put(plot.column(0.0), y, glyphs.zero_line, palette.dim)
            _draw_bar(canvas, rows, arm, plot, look)
            _draw_numbers(canvas, top, arm, total, plot, look, form)
        else:
            _draw_value(canvas, top, arm, left, look, form)
    axis = len(arms) * each
    if axis < height and plot.width >= _LEAST_PLOT:
        _draw_axis(canvas, axis, plot, look)
        if width >= _VALUES_FROM and total:
            heads = f"{'Q':>{_VALUE}}{'pulls':>{_PULLS}}{'share':>{_SHARE}}"
            canvas.put(plot.left + plot.width + 1, axis, heads[: _beside(width) - 2], palette.dim)


def _draw_head(canvas: Canvas, y: int, arm: Arm, names: int, look: Look) -> None:
    glyphs, palette = look.glyphs, look.palette
    if arm.greedy:
        canvas.put(0, y, glyphs.cursor, palette.best)
    if arm.last:
        canvas.put(1, y, glyphs.agent, palette.agent)
    name = shortened(glyphs.spelled(arm.name), names, glyphs.ellipsis)
    style = palette.focus if arm.cursor else palette.best if arm.greedy else palette.text
    end = names + _AROUND_NAME - 1
    canvas.put(end - cell_len(name), y, name, style)
    if arm.stops:
        canvas.put(end, y, glyphs.breakpoint, palette.breakpoint)


def _draw_bar(canvas: Canvas, rows: range, arm: Arm, plot: _Plot, look: Look) -> None:
    glyphs, palette, y = look.glyphs, look.palette, rows.start
    bar = range(0)
    if arm.error is None:
        _draw_not_pulled(canvas, y, arm, plot, look)
    else:
        ground, ink = _bar_ground(arm.greedy, palette), palette.best if arm.greedy else palette.text
        zero, end = plot.column(0.0), plot.column(arm.estimate)
        bar = range(min(zero, end), max(zero, end) + 1) if end != zero else bar
        first, last = plot.column(arm.estimate - arm.error), plot.column(arm.estimate + arm.error) + 1
        line = glyphs.whisker * (end - first) + glyphs.bar_end + glyphs.whisker * (last - end - 1)
        canvas.put(first, y, line, ink)
        for row in rows:
            canvas.put(bar.start, row, (" " if ground.bgcolor else glyphs.bar) * len(bar), ground)
            if bar and ground.bgcolor:  # the line of 0 is in the middle of its cell
                canvas.put(zero, row, glyphs.half_bar[end > zero], Style(color=ground.bgcolor))
        for x in range(max(first, bar.start), min(last, bar.stop)):
            if x != zero:
                canvas.put(x, y, line[x - first], ground if ground.bgcolor else ink)
    if arm.mean is not None:
        x = plot.column(arm.mean)
        ink = _bar_ground(arm.greedy, palette) if x in bar else palette.optimum  # no notch in the bar
        canvas.put(x, y, true_mean_glyph(look), ink + Style(bold=True))
    if arm.best:
        canvas.put(plot.left + plot.width, y, glyphs.best_arm, palette.optimum + Style(bold=True))


@lru_cache(8)
def _bar_ground(greedy: bool, palette: Palette) -> Style:
    colour, page = (palette.best if greedy else palette.press).color, palette.page.color
    if colour is None or page is None:
        return palette.text
    if greedy or colour.type is ColorType.STANDARD:
        return Style(color=page, bgcolor=colour)
    return palette.strong + Style(bgcolor=faded(Style(color=colour, bgcolor=page), _DEPTH).color)


def _draw_numbers(
    canvas: Canvas, y: int, arm: Arm, total: int, plot: _Plot, look: Look, form: NumberForm
) -> None:
    if canvas.width < _VALUES_FROM or arm.error is None:
        return
    palette, x = look.palette, plot.left + plot.width + 1
    style = palette.best + Style(bold=True) if arm.greedy else palette.text
    canvas.put(x, y, f"{form.text(arm.estimate, look.glyphs):>{_VALUE}}", style)
    counts = f"{numbers.count(arm.pulls, _PULLS - 1):>{_PULLS}}"
    if canvas.width >= _SHARES_FROM:
        counts += f"{arm.pulls / total:>{_SHARE}.0%}".replace("%", " %")[1:]
    canvas.put(x + _VALUE, y, counts, palette.dim)


def _draw_not_pulled(canvas: Canvas, y: int, arm: Arm, plot: _Plot, look: Look) -> None:
    end = plot.left + plot.width
    mark = end + 1 if arm.mean is None else plot.column(arm.mean)
    for text in NOT_PULLED:
        for start, behind in ((plot.left, min(end, mark - 1)), (mark + 2, end)):
            if start + len(text) <= behind:
                canvas.put(start, y, text, look.palette.dim)
                return


def _draw_value(canvas: Canvas, y: int, arm: Arm, left: int, look: Look, form: NumberForm) -> None:
    if canvas.width - left < _LEAST_VALUE:
        return
    text = look.glyphs.ellipsis if arm.error is None else form.text(arm.estimate, look.glyphs)
    canvas.put(left, y, text, look.palette.best if arm.greedy else look.palette.text)


def _draw_axis(canvas: Canvas, y: int, plot: _Plot, look: Look) -> None:
    end = -1
    for value in ticks(plot.scale, max(2, (plot.width + 1) // 8)):
        text = bound_text(value, look.glyphs)
        x = min(plot.column(value) - len(text) // 2, canvas.width - len(text))
        if x > end:
            canvas.put(x, y, text, look.palette.dim)
            end = x + len(text)
