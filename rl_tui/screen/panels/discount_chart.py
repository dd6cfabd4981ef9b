"""A chart of Q*(γ) for one state's actions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np
from rich.cells import cell_len
from rich.style import Style
from textual.strip import Strip

from rl_tui.runs.answers.flip_answer import OptimalValueCurves
from rl_tui.screen.draw import braille
from rl_tui.screen.draw.action_order import shown_pairs
from rl_tui.screen.draw.axes import apart, draw_count_axis, draw_value_axis, value_axis_columns
from rl_tui.screen.draw.braille import Steps
from rl_tui.screen.draw.canvas import Canvas, shortened
from rl_tui.screen.draw.chart_plot import Plot
from rl_tui.screen.draw.names import action_name
from rl_tui.screen.draw.numbers import NEGLIGIBLE
from rl_tui.screen.draw.scale import Scale, tight_scale
from rl_tui.screen.theme.look import Look
from rl_tui.worlds.mdp.space import BoolArray, FloatArray
from rl_tui.worlds.world import World

if TYPE_CHECKING:
    from rl_tui.agents.exact.flips import Flip

LEAST_WIDTH: Final = 18
LEAST_HEIGHT: Final = 4
_ROOMY: Final = 36  # columns from which labels are a fifth apart: narrower charts have three
_SIGNS_APART: Final = 12  # columns between two signs on a line
_IN_FRONT: Final = 2  # lines: of so few, the first covers the other
_SIGN_FREE: Final = 2  # columns without a sign at the end, where it would look like part of the name
_NAMES_SHARE: Final = 0.4  # share of the columns, for names if they fit completely


@dataclass(frozen=True, slots=True)
class ActionLine:
    """Q*(γ) of one action, [G], with a one-cell ``sign``, or one sign for each γ."""

    name: str
    sign: str
    values: FloatArray
    style: Style


def action_lines(world: World, curves: OptimalValueCurves, state: int, look: Look) -> list[ActionLine]:
    """Return the actions' lines in ``state``."""
    pairs = shown_pairs(world, world.space.pairs_of(state))
    names = [
        look.glyphs.spelled(action_name(world, int(world.space.pair_action[pair]), look.glyphs))
        for pair in pairs
    ]
    firsts = [name[:1] for name in names]
    is_clear = len(set(firsts)) == len(firsts) and "" not in firsts
    styles = look.palette.lanes
    return [
        ActionLine(
            name=name if is_clear else f"{number} {name}",
            sign=name[0] if is_clear else str(number)[-1],
            values=curves.q[:, pair],
            style=styles[(number - 1) % len(styles)],
        )
        for number, (name, pair) in enumerate(zip(names, pairs, strict=True), start=1)
    ]


def best_two(lines: Sequence[ActionLine], look: Look) -> list[ActionLine]:
    """Return the two highest values at each γ, the best with the sign of its action."""
    values = np.array([np.nan_to_num(line.values, nan=-np.inf) for line in lines])
    signs = "".join(lines[place].sign for place in values.argmax(axis=0).tolist())
    ordered = np.sort(values, axis=0)[::-1]
    ordered[np.isneginf(ordered)] = np.nan
    best = ActionLine("best", signs, ordered[0], look.palette.best)
    return [
        best,
        *(ActionLine("second", look.glyphs.untried, each, look.palette.dim) for each in ordered[1:2]),
    ]


def ranked(lines: Sequence[ActionLine]) -> list[ActionLine]:
    """Rescale at each γ: best action 1, worst 0, gaps if all are equal. It shows close crossings."""
    values = np.array([line.values for line in lines])
    low, high = values.min(axis=0), values.max(axis=0)
    between = np.where(high - low > NEGLIGIBLE * np.maximum(1.0, np.abs(high)), high - low, np.nan)
    return [replace(line, values=(line.values - low) / between) for line in lines]


def draw_values(
    lines: Sequence[ActionLine],
    gammas: FloatArray,
    flips: Sequence[Flip],
    state: int,
    gamma: float,
    chosen: Flip | None,
    look: Look,
    width: int,
    height: int,
) -> list[Strip]:
    """Draw ``lines`` over ``gammas`` [G]. Flips in ``state`` are marked on its lines."""
    canvas = Canvas(width, height, look.palette.text)
    if width < LEAST_WIDTH or height < LEAST_HEIGHT or not lines:
        return canvas.strips()
    values = np.array([line.values for line in lines])
    finite = values[np.isfinite(values)]
    scale = _scale(finite)
    left = value_axis_columns(scale, look)
    unit = look.glyphs.spelled(" γ")
    names = max(cell_len(line.name) for line in lines)
    if names > round(_NAMES_SHARE * (width - left)):
        names = (width - left) // 3
    names = max(names, cell_len(unit) - 1)
    plot = Plot(left, width - left - names - 1, height - 1, 1.0, scale)
    draw_value_axis(canvas, plot, look)
    step = 0.2 if plot.columns >= _ROOMY else 0.5
    draw_count_axis(canvas, plot, 1.0, 6, unit, look, step)
    _draw_marks(canvas, plot, flips, gamma, chosen, look)
    _draw_lines(canvas, plot, lines, gammas, look)
    now = int(np.abs(gammas - gamma).argmin())
    best = np.nan_to_num(values.max(axis=0))
    row = plot.row(float(best[now])) if gamma <= gammas[-1] else 0
    canvas.put(plot.left + _column(plot, gamma), row, look.glyphs.thumb, look.palette.press)
    for flip in flips:
        if any(turn.state == state for turn in flip.turns):
            row = plot.row(float(np.interp(flip.gamma, gammas, best)))
            canvas.put(
                plot.left + _column(plot, flip.gamma), row, look.glyphs.change_mark, look.palette.strong
            )
    _draw_names(canvas, plot, lines, look)
    return canvas.strips()


def _scale(values: FloatArray) -> Scale:
    """Return an axis close to ``values``, with labels at its ends and at 0."""
    if not len(values):
        return Scale(0.0, 1.0, 1.0)
    low, high = min(0.0, float(values.min())), max(0.0, float(values.max()))
    scale = tight_scale(low, high)
    return replace(scale, step=max(-scale.low, scale.high))


def _column(plot: Plot, gamma: float) -> int:
    return min(plot.columns - 1, plot.column(gamma))


def _draw_marks(
    canvas: Canvas, plot: Plot, flips: Sequence[Flip], gamma: float, chosen: Flip | None, look: Look
) -> None:
    glyphs, palette = look.glyphs, look.palette
    marks = [
        (flip.gamma, flip_sign(flip, look), flip_style(flip, look))
        for flip in sorted(flips, key=lambda flip: flip.turns_the_way)
    ]
    marks.append((gamma, glyphs.untried, palette.press))
    if chosen is not None:
        marks.append((chosen.gamma, flip_sign(chosen, look), palette.focus))
    for at, glyph, style in marks:
        for row in range(plot.rows):
            canvas.put(plot.left + _column(plot, at), row, glyph, style)


def flip_sign(flip: Flip, look: Look) -> str:
    """Return a flip's sign."""
    return look.glyphs.flip if flip.turns_the_way else look.glyphs.side_flip


def flip_style(flip: Flip, look: Look) -> Style:
    """Return a flip's style, brighter on the optimal path."""
    return look.palette.best if flip.turns_the_way else look.palette.dim


def _draw_lines(
    canvas: Canvas, plot: Plot, lines: Sequence[ActionLine], gammas: FloatArray, look: Look
) -> None:
    dot = 1.0 / (braille.DOTS_ACROSS * plot.columns)  # the width of one dot, so that lines stay thin
    dots = np.arange(0.0, 1.0, dot)
    passes = list[BoolArray]()
    signs = [[ord(each) for each in _signs(line, gammas, plot)] for line in lines]
    codes = np.zeros((len(lines), plot.rows, plot.columns), dtype=np.int64)
    for number, line in enumerate(lines):
        values = np.interp(dots + 0.5 * dot, gammas, line.values, right=np.nan)
        drawn = plot.braille_line(Steps(dots, dots + dot, values, values))
        passes.append(drawn > braille.BLANK)
        codes[number] = drawn if look.glyphs.braille else signs[number]
    there = np.stack(passes)
    whose = (
        braille.in_turns(there)
        if len(lines) > _IN_FRONT
        else np.where(there.any(axis=0), there.argmax(axis=0), -1)
    )
    shown = np.take_along_axis(codes, np.maximum(whose, 0)[None], axis=0)[0]
    for number in range(len(lines) if look.glyphs.braille else 0):
        first = _SIGNS_APART * (number + 1) // (len(lines) + 1)
        is_seen = passes[number] if len(lines) > _IN_FRONT else whose == number
        for column in range(first, plot.columns - _SIGN_FREE, _SIGNS_APART):
            at = np.flatnonzero(is_seen[:, column])[:1], column
            shown[at], whose[at] = signs[number][column], number
    for row, column in np.argwhere(whose >= 0).tolist():
        style = lines[whose[row, column]].style
        canvas.put(plot.left + column, row, chr(shown[row, column]), style)


def _signs(line: ActionLine, gammas: FloatArray, plot: Plot) -> str:
    places = np.interp((np.arange(plot.columns) + 0.5) / plot.columns, gammas, np.arange(len(gammas)))
    return "".join(line.sign[min(round(place), len(line.sign) - 1)] for place in places.tolist())


def _draw_names(canvas: Canvas, plot: Plot, lines: Sequence[ActionLine], look: Look) -> None:
    ends = [(_end(line), line) for line in lines]
    downwards = sorted(ends, key=lambda each: -each[0])[: plot.rows]
    rows = apart([plot.row(end) for end, _ in downwards], plot.rows)
    x = plot.left + plot.columns + 1
    for (_, line), row in zip(downwards, rows, strict=True):
        canvas.put(x, row, shortened(line.name, canvas.width - x, look.glyphs.ellipsis), line.style)


def _end(line: ActionLine) -> float:
    known = line.values[np.isfinite(line.values)]
    return float(known[-1]) if len(known) else 0.0
