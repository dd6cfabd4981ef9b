"""The return curve as character cells: axes, lines in dots, and names at the ends of the lines.

All cell arrays are [rows, columns]. With several runs, each line has the colour of its run, or its
number.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt
from rich.cells import cell_len
from rich.style import Style
from textual.strip import Strip

from rl_tui.screen.draw import braille
from rl_tui.screen.draw.axes import apart, draw_count_axis, draw_value_axis, value_axis_columns
from rl_tui.screen.draw.braille import Steps
from rl_tui.screen.draw.canvas import Canvas, Line, Piece, shortened, wrapped
from rl_tui.screen.draw.chart_plot import Plot
from rl_tui.screen.draw.scale import Scale, round_range
from rl_tui.screen.panels.curve.data import CurveData
from rl_tui.screen.panels.curve.lane_text import lane_columns, lane_labels
from rl_tui.screen.panels.curve.seed_band import seed_cells
from rl_tui.screen.panels.curve.text import LineLabel, barren_words, empty_words, label_columns, labels
from rl_tui.screen.panels.curve.world_marks import draw_marks, lines_of, world_marks
from rl_tui.screen.theme.look import Look

# The chart


# The lines of several runs


_TURN: Final = 2  # columns in which one of several lines in the same cells is seen
_MARKS_APART: Final = 16  # columns from one number on a line to the next
_LaneCodes = npt.NDArray[np.int64]


class LaneCells(NamedTuple):
    """What is in each cell, [rows, columns]: the code of its character, 0 where there is none.

    ``line`` tells whose it is: −1 no line's, 0 the greedy line's, n that of lane n.
    """

    codes: _LaneCodes
    line: _LaneCodes


def lane_cells(plot: Plot, data: CurveData, look: Look) -> LaneCells:
    """Return the mean of every lane, and of the lane shown the greedy line."""
    layers = (_lanes_in_braille if look.glyphs.braille else _lanes_in_ascii)(plot, data)
    there = layers > 0
    line = _whose(_with_greedy_behind(there))
    codes = np.take_along_axis(layers, np.maximum(line, 0)[None], axis=0)[0]
    codes[line < 0] = 0
    if look.glyphs.braille and not look.palette.tells_lanes_apart:
        _mark(codes, line, there)
    return LaneCells(codes, line)


def _lanes_in_braille(plot: Plot, data: CurveData) -> _LaneCodes:
    """Return the characters of greedy line and lanes, [1 + lanes, rows, columns]."""
    return np.stack([_blank_as_none(plot.braille_line(line)) for line in data.lines])


def _lanes_in_ascii(plot: Plot, data: CurveData) -> _LaneCodes:
    """Return a star for the greedy line and for each lane its number."""
    dots = np.stack([plot.line_dots(line, plot.columns, plot.rows) for line in data.lines])
    signs = np.array([ord("*"), *(ord(str(lane.number)) for lane in data.lanes)])
    return np.asarray(dots * signs[:, None, None])


def _blank_as_none(codes: _LaneCodes) -> _LaneCodes:
    return np.where(codes > braille.BLANK, codes, 0)


def _with_greedy_behind(there: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
    """Return the cells of lines, [lines, rows, columns], where the greedy one goes behind the lanes.

    That is where it goes up and down: as many policies as it passes through, it would cover all else.
    """
    goes_up_or_down = there[0].sum(axis=0) > 1
    behind = there[1:].any(axis=0) & goes_up_or_down
    return np.concatenate(((there[0] & ~behind)[None], there[1:]))


def _whose(there: npt.NDArray[np.bool_]) -> _LaneCodes:
    """Return which of the lines that are ``there``, [lines, rows, columns], each cell shows; −1: none.

    Lines that share cells take turns, so that none hides another.
    """
    among = np.cumsum(there, axis=0)
    count = among[-1]
    turn = np.arange(there.shape[2]) // _TURN % np.maximum(count, 1)
    chosen = there & (among == turn + 1)
    return np.where(count > 0, chosen.argmax(axis=0), -1)


def _mark(codes: _LaneCodes, line: _LaneCodes, there: npt.NDArray[np.bool_]) -> None:
    """Write the number of each lane on its line now and then, in columns of its own."""
    lanes = len(there) - 1
    for number in range(1, lanes + 1):
        first = (number - 1) * _MARKS_APART // lanes + 1
        for column in range(first, codes.shape[1], _MARKS_APART):
            rows = np.flatnonzero(there[number, :, column])
            if len(rows):
                codes[rows[0], column], line[rows[0], column] = ord(str(number)), number


# The chart


LEAST_WIDTH: Final = 14
LEAST_HEIGHT: Final = 3
_TICK_COLUMNS: Final = 9  # a labelled episode number at most every so many columns
_UNIT_ROOM: Final = 40
_ARROWS_APART: Final = 8  # columns between the arrows of a line that stays below the axis
# What a cell shows, the more important the greater; after the greedy line come the lanes
_NOTHING, _CHANGE, _LEVEL, _STUDIED, _SEEDS, _EPISODES, _GREEDY = range(7)


def plot_columns(scale: Scale, look: Look, width: int) -> int:
    """Return how many of ``width`` columns are right of the vertical axis and its labels."""
    return width - value_axis_columns(scale, look)


def plot_of(data: CurveData, scale: Scale, look: Look, width: int, height: int) -> Plot:
    """Return where the lines stand among ``width`` × ``height`` cells; its sizes are 1 at the least."""
    columns = plot_columns(scale, look, width)
    columns_of = lane_columns if data.lanes else label_columns
    reserved = min(columns_of(data, look, columns), columns - 2)
    right = round_range(data.furthest, data.limit)
    return Plot(width - columns, max(1, columns - reserved), max(1, height - 1), right, scale)


def draw_chart(
    data: CurveData, scale: Scale, look: Look, decimals: int, width: int, height: int
) -> list[Strip]:
    """Return ``height`` strips of ``width`` cells, with numbers of so many decimals beside the lines."""
    canvas = Canvas(width, height, look.palette.text)
    labels_of = lane_labels if data.lanes else labels
    if width < LEAST_WIDTH or height < LEAST_HEIGHT:
        return _figures_only(canvas, labels_of(data, look, decimals, width), look)
    plot = plot_of(data, scale, look, width, height)
    draw_value_axis(canvas, plot, look)
    _draw_episode_axis(canvas, plot, data, look)
    if data.furthest:
        _draw_lines(canvas, plot, data, look)
    draw_marks(canvas, world_marks(data.world_changes, plot), plot, look)
    _draw_names(canvas, plot, data, labels_of(data, look, decimals, width - plot.left), look)
    return canvas.strips()


def _figures_only(canvas: Canvas, names: Sequence[LineLabel], look: Look) -> list[Strip]:
    for y, label in enumerate(names[: canvas.height]):
        canvas.put(0, y, shortened(label.text, canvas.width, look.glyphs.ellipsis), label.style)
    return canvas.strips()


def _draw_episode_axis(canvas: Canvas, plot: Plot, data: CurveData, look: Look) -> None:
    """Draw the axis with its labels, none beyond the last episode there can be."""
    if data.has_both_units:
        unit = " ep, sweep"
    else:
        unit = " ep" if data.unit == "episode" and canvas.width < _UNIT_ROOM else f" {data.unit}"
    draw_count_axis(canvas, plot, plot.right, max(2, plot.columns // _TICK_COLUMNS), unit, look)


def _draw_lines(canvas: Canvas, plot: Plot, data: CurveData, look: Look) -> None:
    """Put every line into the plot; where they share a cell the more important shows."""
    if data.lanes:
        _draw_lanes(canvas, plot, data, look)
        return
    codes = _braille(plot, data) if look.glyphs.braille else _ascii(plot, data)
    shown, kind = np.zeros((2, plot.rows, plot.columns), dtype=np.int64)
    _put_changes(shown, kind, plot, data, look)
    _put_levels(shown, kind, plot, data, look)
    seeds, _ = seed_cells(plot, data.seeds, look)
    for line, what, where in (
        (seeds, _SEEDS, True),
        (codes.episodes, _EPISODES, True),
        (codes.greedy, _GREEDY, ~codes.yielded),
    ):
        there = (line > 0) & where
        shown[there], kind[there] = line[there], what
    _mark_off_axis(shown, kind, off_axis(plot, data.lines), _EPISODES, look)
    palette = look.palette
    styles = (
        palette.text,
        palette.dim,
        palette.optimum,
        palette.good,
        palette.dim,
        palette.episodes,
        palette.greedy_line,
    )
    _put_cells(canvas, plot, kind, shown, styles)


def _draw_lanes(canvas: Canvas, plot: Plot, data: CurveData, look: Look) -> None:
    """Put the lines of runs side by side into the plot, over the level of the optimum."""
    cells, palette = lane_cells(plot, data, look), look.palette
    shown, kind = np.zeros((2, plot.rows, plot.columns), dtype=np.int64)
    _put_changes(shown, kind, plot, data, look)
    _put_levels(shown, kind, plot, data, look)
    seeds, whose = seed_cells(plot, data.seeds, look)
    shown[seeds > 0], kind[seeds > 0] = seeds[seeds > 0], (_GREEDY + len(palette.lanes) + whose)[seeds > 0]
    there = cells.line >= 0
    shown[there], kind[there] = cells.codes[there], _GREEDY + cells.line[there]
    _mark_off_axis(shown, kind, off_axis(plot, data.lines), _GREEDY, look)
    styles = (
        palette.text,
        palette.dim,
        palette.optimum,
        palette.good,
        palette.dim,
        palette.episodes,
        palette.greedy_line,
        *palette.lanes,
        *(style + Style(dim=True) for style in palette.lanes),
    )
    _put_cells(canvas, plot, kind, shown, styles)


def off_axis(plot: Plot, lines: Sequence[Steps]) -> npt.NDArray[np.int64]:
    """Return the number of the line, from 0, that goes below the axis in each column, [columns]; −1: none.

    A line has an entry where it leaves the axis, and further ones as long as it stays away.
    """
    found = np.full(plot.columns, -1)
    places = np.arange(plot.columns)
    for number, line in enumerate(lines):
        off = plot.below(line) & (found < 0)
        if not off.any():
            continue
        begins = off & ~np.concatenate(([False], off[:-1]))
        since = places - np.maximum.accumulate(np.where(begins, places, 0))
        found[off & (since % _ARROWS_APART == 0)] = number
    return found


def _mark_off_axis(
    shown: npt.NDArray[np.int64],
    kind: npt.NDArray[np.int64],
    off: npt.NDArray[np.int64],
    first_kind: int,
    look: Look,
) -> None:
    """Put arrows into the lowest row of ``shown`` and ``kind``, [rows, columns], where lines are off."""
    there = off >= 0
    shown[-1, there], kind[-1, there] = ord(look.glyphs.down), first_kind + off[there]


def _put_changes(
    shown: npt.NDArray[np.int64], kind: npt.NDArray[np.int64], plot: Plot, data: CurveData, look: Look
) -> None:
    """Put lines where the world changed into ``shown`` and ``kind``, as far as nothing is there."""
    for column in lines_of(world_marks(data.world_changes, plot), plot):
        free = kind[:, column] == _NOTHING
        shown[free, column], kind[free, column] = ord(look.glyphs.zero_line), _CHANGE


def _put_levels(
    shown: npt.NDArray[np.int64], kind: npt.NDArray[np.int64], plot: Plot, data: CurveData, look: Look
) -> None:
    """Put the levels of the optimum and of the policy studied into ``shown`` and ``kind``."""
    studied = None if data.studied is None else data.studied.value
    levels = ((studied, look.glyphs.dashes, _STUDIED), (data.optimum, look.glyphs.level, _LEVEL))
    for value, glyph, what in levels:
        if value is not None and (value >= plot.scale.low or what is _LEVEL):
            level = _level_cells(plot, data, value, look)
            shown[level], kind[level] = ord(glyph), what


def _level_cells(plot: Plot, data: CurveData, value: float, look: Look) -> tuple[int, slice]:
    """Return the cells of a level line: its row, and its columns over the episodes in this world."""
    every = 1 if look.glyphs.braille else 2
    return plot.row(value), slice(plot.column(data.world_since), plot.column(data.furthest) + 1, every)


class _Codes(NamedTuple):
    """The characters of each line, [rows, columns], 0 for none, and where the greedy one is interrupted."""

    episodes: npt.NDArray[np.int64]
    greedy: npt.NDArray[np.int64]
    yielded: npt.NDArray[np.bool_]


def _braille(plot: Plot, data: CurveData) -> _Codes:
    episodes = plot.braille_line(data.episodes) - braille.BLANK
    greedy = plot.braille_line(data.greedy) - braille.BLANK
    yielded = taking_turns(greedy, episodes)
    return _Codes(_characters(episodes), _characters(greedy), yielded)


def _characters(dots: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    return np.where(dots > 0, dots + braille.BLANK, 0)


def _ascii(plot: Plot, data: CurveData) -> _Codes:
    """Return ``'`` ``.`` ``:`` for the upper and lower half of the cells of a line, ``*`` for greedy's."""
    episodes, greedy = plot.halves(data.episodes), plot.halves(data.greedy)
    codes = np.array([0, ord("'"), ord("."), ord(":")])[episodes]
    return _Codes(codes, np.where(greedy > 0, ord("*"), 0), taking_turns(greedy, episodes))


def taking_turns(first: npt.NDArray[np.int64], second: npt.NDArray[np.int64]) -> npt.NDArray[np.bool_]:
    """Return the cells, [rows, columns], in which the second line is drawn, not the first.

    Both are bits, one a dot. Where the lines run side by side through one row of cells, but not on the same
    dots, every other cell shows the second.
    """
    shared = (first > 0) & (second & ~first > 0)
    beside = shared.copy()
    beside[:, 1:] &= shared[:, :-1]
    beside[:, ::2] = False
    return beside


def _put_cells(
    canvas: Canvas,
    plot: Plot,
    kinds: npt.NDArray[np.int64],
    codes: npt.NDArray[np.int64],
    styles: Sequence[Style],
) -> None:
    """Write the characters ``codes``, 0 for none, into the plot, each in that of ``styles`` of its kind."""
    text = np.where(codes > 0, codes, ord(" ")).astype("<u4").tobytes().decode("utf-32-le")
    for row, each in enumerate(kinds.tolist()):
        line = text[row * plot.columns : (row + 1) * plot.columns]
        canvas.put_cells(plot.left, row, line, [styles[kind] for kind in each])


def _draw_names(canvas: Canvas, plot: Plot, data: CurveData, names: Sequence[LineLabel], look: Look) -> None:
    """Write the names of the lines beside their ends, and what is to be said where there is no line."""
    if not data.furthest:
        _put_message(canvas, plot, empty_words(data.unit), look, set())
        return
    x = plot.left + plot.column(data.furthest) + 2
    rows = set()
    for label, row in _rows_of(names[: plot.rows], plot):
        rows.add(row)
        width = cell_len(label.text)
        # no line ends in the row of a name without one, so it may reach into the plot
        start = x if label.value >= plot.scale.low else min(x, canvas.width - width)
        if start + width <= canvas.width:
            canvas.put(start, row, label.text, label.style)
        if -math.inf < label.value < plot.scale.low:
            canvas.put(start - 2, row, look.glyphs.down, label.style)
    if (data.barren or data.unlearned) and not data.lanes:
        _put_message(canvas, plot, barren_words(data), look, {*rows, plot.rows - 1})


def _put_message(canvas: Canvas, plot: Plot, words: Sequence[str], look: Look, taken: set[int]) -> None:
    """Write ``words`` into rows that are not ``taken``: on one line if they fit, else on a line each."""
    columns = canvas.width - plot.left
    room = columns - 2
    whole = " ".join(words)
    parts = (whole,) if len(whole) <= room else words
    lines = [line for part in parts for line in wrapped(part, room, look.palette.text, look)]
    middle = (plot.rows - len(lines)) / 2
    begins = range(max(0, plot.rows - len(lines)) + 1)
    free = [row for row in begins if not taken.intersection(range(row, row + len(lines)))]
    if not free:
        return
    first = min(free, key=lambda row: abs(row - middle))
    for row, line in enumerate(lines[: plot.rows], first):
        for piece in line:
            x = plot.left + max(1, (columns - cell_len(piece.text)) // 2)
            canvas.put(x, row, piece.text, piece.style)


def _rows_of(names: Sequence[LineLabel], plot: Plot) -> list[tuple[LineLabel, int]]:
    """Return ``names`` with a row each: where their lines end; names without an end there give way to them.

    Of equals the optimum, which comes last, is above.
    """
    downwards = [label for _, label in sorted(enumerate(names), key=lambda each: (-each[1].value, -each[0]))]
    with_end = [label for label in downwards if label.value >= plot.scale.low]
    rows = apart([plot.row(label.value) for label in with_end], plot.rows)
    free = [row for row in reversed(range(plot.rows)) if row not in rows]
    without_end = downwards[len(with_end) :]
    return [*zip(with_end, rows, strict=True), *zip(without_end, free, strict=False)]


# The curve in one row


_EIGHTHS: Final = "▁▂▃▄▅▆▇█"
_EIGHTHS_ASCII: Final = "_.:-=+*#"


def spark_line(data: CurveData, scale: Scale, look: Look, width: int, words: str) -> Line:
    """Return the means of the episodes in one row of ``width`` cells, and ``words`` behind them."""
    columns = width - cell_len(words) - 2
    if columns < 1 or not len(data.episodes.start):
        return [Piece(words, look.palette.dim)]
    marks = _EIGHTHS if look.glyphs.braille else _EIGHTHS_ASCII
    places = np.linspace(data.episodes.start[0], data.episodes.end[-1], columns, endpoint=False)
    at = np.clip(np.searchsorted(data.episodes.start, places, side="right") - 1, 0, None)
    heights = (data.episodes.high[at] - scale.low) / (scale.high - scale.low)
    signs = np.clip(np.nan_to_num(heights) * len(marks), 0, len(marks) - 1).astype(int)
    return [
        Piece("".join(marks[each] for each in signs), look.palette.episodes),
        Piece(f"  {words}", look.palette.dim),
    ]
