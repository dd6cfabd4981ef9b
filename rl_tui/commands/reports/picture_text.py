"""Pictures for the terminal: curves of braille dots and coloured settings maps."""

from __future__ import annotations

import os
import shutil
import sys
from collections.abc import Iterator, Sequence
from itertools import product
from string import ascii_letters
from textwrap import fill
from typing import TYPE_CHECKING, Final

import click
import numpy as np
from rich.cells import cell_len
from rich.color import ColorSystem

from rl_tui.commands.line.output import alike, columns, number
from rl_tui.common.words import counted
from rl_tui.screen.draw import braille
from rl_tui.screen.draw.canvas import shortened
from rl_tui.screen.theme.glyphs import ASCII
from rl_tui.screen.theme.look import can_encode, depth_of, palette_for
from rl_tui.studies.book_figures.catalogue import BOOK, BookFigure
from rl_tui.studies.book_figures.figure import BookComparison, MeasuredFigure
from rl_tui.studies.pictures.chart_layout import spread
from rl_tui.studies.pictures.picture import AtlasChart, Chart, ChartCurve, Picture, number_text

if TYPE_CHECKING:
    from rl_tui.screen.theme.look import Depth
    from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray


# Settings maps


BEST, ALIKE, MISSING = "*", "'", "-"
_SYSTEMS: Final = {
    "16": ColorSystem.STANDARD,
    "256": ColorSystem.EIGHT_BIT,
    "truecolor": ColorSystem.TRUECOLOR,
}
_ATLAS_TEXT_MOST_NAME: Final = 16
_DIGITS: Final = 3
_TINT: Final = 2  # width of a cell without a number
_MOST_BLOCKS: Final = 2
_SCALE: Final = 20  # width of the colour scale


def atlas_lines(atlas: AtlasChart, columns: int, depth: Depth) -> Iterator[str]:
    """Yield the lines of a settings map, the highest row first.

    Cells that do not fit are split into blocks below one another. Instead of more than two blocks, cells show
    only colours, if they fit.
    """
    numbers = _Cells(atlas, depth)
    left = max(cell_len(name) for name in numbers.row_names) + 2
    room = columns - left
    yield f"{atlas.y_label} ↑  {atlas.x_label} →"
    at_once = max(1, room // numbers.width)
    is_long = len(atlas.columns) > _MOST_BLOCKS * at_once
    if is_long and depth != "none" and _TINT * len(atlas.columns) <= room:
        yield from _tints(numbers, left)
    else:
        for first in range(0, len(atlas.columns), at_once):
            if first:
                yield ""
            yield from _block(numbers, left, range(first, min(first + at_once, len(atlas.columns))))
    marks = [f"{BEST} the best"] if atlas.best is not None else []
    if numbers.marked:
        marks.append(f"{ALIKE} tied with the best")
    if marks:
        yield "   ".join(marks)


class _Cells:
    def __init__(self, atlas: AtlasChart, depth: Depth) -> None:
        self.atlas = atlas
        self.depth: Depth = depth
        self.marked = atlas.marked
        self.row_names = [shortened(name, _ATLAS_TEXT_MOST_NAME, "…") for name in atlas.rows]
        self.column_names = [shortened(name, _ATLAS_TEXT_MOST_NAME, "…") for name in atlas.columns]
        places = product(range(len(atlas.rows)), range(len(atlas.columns)))
        texts = [self._number(row, column) for row, column in places]
        self.width = 2 + max(map(cell_len, (*texts, *self.column_names)))
        """Width of a cell with its number, including one column of space."""

    def mark(self, row: int, column: int) -> str:
        if self.atlas.best == (row, column):
            return BEST
        return ALIKE if (row, column) in self.marked else " "

    def _number(self, row: int, column: int) -> str:
        value = self.atlas.values[row][column]
        return f"{MISSING} " if value is None else number_text(value, _DIGITS) + self.mark(row, column)

    def number(self, row: int, column: int) -> str:
        text = self._number(row, column)
        blanks = " " * (self.width - 1 - cell_len(text))
        return self.tinted(blanks + text, self.atlas.values[row][column])

    def tint(self, row: int, column: int) -> str:
        value = self.atlas.values[row][column]
        return self.tinted(f"{' ' if value is not None else MISSING}{self.mark(row, column)}", value)

    def tinted(self, text: str, value: float | None) -> str:
        if self.depth == "none" or value is None:
            return text
        style = palette_for(self.depth, True).value(self.atlas.scale.share(value))
        return style.render(text, color_system=_SYSTEMS[self.depth])


def _block(cells: _Cells, left: int, shown: Sequence[int]) -> Iterator[str]:
    for row in reversed(range(len(cells.atlas.rows))):
        numbers = " ".join(cells.number(row, column) for column in shown)
        yield f"{cells.row_names[row]:>{left - 2}}  {numbers}".rstrip()
    names = " ".join(f"{cells.column_names[column]:>{cells.width - 1}}" for column in shown)
    yield f"{'':{left}}{names}"


def _tints(cells: _Cells, left: int) -> Iterator[str]:
    # All columns as colours, the names that fit, and the colour scale
    atlas = cells.atlas
    for row in reversed(range(len(atlas.rows))):
        tints = "".join(cells.tint(row, column) for column in range(len(atlas.columns)))
        yield f"{cells.row_names[row]:>{left - 2}}  {tints}"
    names = " " * left
    for column, name in enumerate(cells.column_names):
        start = left + _TINT * column
        if start >= len(names) and start + cell_len(name) <= left + _TINT * len(atlas.columns):
            names = f"{names:{start}}{name} "
    yield names.rstrip()
    scale = atlas.scale
    steps = (scale.low + (scale.high - scale.low) * (place + 0.5) / _SCALE for place in range(_SCALE))
    shown = "".join(cells.tinted(" ", value) for value in steps)
    yield f"{'':{left}}{scale.labels[0]} {shown} {scale.labels[-1]}"


# Curves


ROWS: Final = 16
_LEAST_COLUMNS: Final = 20
_WIDEST: Final = 120
_MOST_NAME: Final = 34
_SAMPLES: Final = 8  # samples of a curve per column of dots
_DASH: Final = 3  # length of a dash and of a gap, in columns of dots
# Readable on black and on white, and distinguishable with colour blindness
COLOURS_256: Final = (32, 172, 93, 161, 139, 94)
_COLOURS_16: Final = ("blue", "yellow", "magenta", "red", "cyan", "green")


def print_picture(picture: Picture, *, err: bool = False) -> None:
    """Print `picture` in a form that suits the terminal, on stdout or stderr."""
    stream = sys.stderr if err else sys.stdout
    is_terminal = stream.isatty()
    columns = shutil.get_terminal_size().columns if is_terminal else 80
    depth = depth_of("auto", os.environ) if is_terminal else "none"
    ascii_only = not can_encode(getattr(stream, "encoding", None))
    click.echo(picture_text(picture, min(columns, _WIDEST), depth, ascii_only=ascii_only), err=err)


def picture_text(picture: Picture, columns: int, depth: Depth = "none", *, ascii_only: bool = False) -> str:
    """Return `picture` in up to `columns` characters, with escape sequences for colours.

    With `ascii_only`, each curve has its own letter.
    """
    lines = [picture.title]
    for panel in picture.panels:
        lines += ["", panel.title] if panel.title else [""]
        lines += (
            _chart_lines(panel, columns, depth, ascii_only)
            if isinstance(panel, Chart)
            else atlas_lines(panel, columns, depth)
        )
    text = "\n".join([*lines, "", *(fill(note, columns) for note in picture.notes)])
    return ASCII.spelled(text) if ascii_only else text


def _chart_lines(chart: Chart, columns: int, depth: Depth, ascii_only: bool) -> Iterator[str]:
    names = [shortened(curve.name, min(_MOST_NAME, columns // 3), "…") for curve in chart.curves]
    if ascii_only:
        names = [ASCII.spelled(f"{_letter(place)} {name}") for place, name in enumerate(names)]
    left = max(map(len, chart.y.labels), default=0) + 1
    width = max(_LEAST_COLUMNS, columns - left - 2 - max(map(len, names), default=0))
    codes, owners = _cells(chart, width)
    labels = {_row(share): label for share, label in zip(chart.y.tick_shares, chart.y.labels, strict=True)}
    beside = _names_by_row(chart)
    tick, line, corner, floor = "+|+-" if ascii_only else "┤│└─"
    if chart.y.label:
        yield chart.y.label
    for row in range(ROWS):
        axis = f"{labels.get(row, ''):>{left - 1}}{tick if row in labels else line}"
        cells = _styled_cells(codes[row], owners[row], chart.curves, depth, ascii_only)
        name = beside.get(row)
        ending = "" if name is None else " " + _coloured(names[name], chart.curves[name].colour, depth)
        yield (axis + cells + ending).rstrip()
    yield " " * (left - 1) + corner + floor * width
    yield _labels_below(chart, left, width)
    yield " " * left + chart.x.label.center(width).rstrip()


def _cells(chart: Chart, width: int) -> tuple[IntArray, IntArray]:
    # Characters and curve (or −1) of each cell, both [rows, width]
    codes = np.full((ROWS, width), 0, dtype=np.int64)
    owners = np.full((ROWS, width), -1, dtype=np.int64)
    for place, curve in enumerate(chart.curves):
        drawn = braille.braille_codes(_dots(chart, curve, width)) - braille.BLANK
        codes |= drawn
        owners[drawn > 0] = place
    return codes + braille.BLANK, owners


def _dots(chart: Chart, curve: ChartCurve, width: int) -> BoolArray:
    across, down = width * braille.DOTS_ACROSS, ROWS * braille.DOTS_DOWN
    dots = np.zeros((down, across), dtype=np.bool_)
    if not chart.connected:
        return _intervals(chart, curve, dots)
    for stretch in curve.stretches:
        x = np.array([chart.x.share(curve.x[place]) for place in stretch])
        y = np.array([chart.y.share(value) for place in stretch if (value := curve.y[place]) is not None])
        low, high = _extent(x, y, across)
        dots |= braille.dots_of(braille.joined(braille.span(low, high, 0.0, 1.0, down)), down)
    if curve.dashed:
        dots[:, np.arange(across) // _DASH % 2 == 1] = False
    return dots


def _intervals(chart: Chart, curve: ChartCurve, dots: BoolArray) -> BoolArray:
    down, across = dots.shape
    for place, value in enumerate(curve.y):
        if value is None:
            continue
        ends = [each[place] if each else None for each in (curve.low, curve.high)]
        shares = [chart.y.share(value if end is None else end) for end in (*ends, value)]
        low, high, middle = (round((1.0 - min(max(share, 0.0), 1.0)) * (down - 1)) for share in shares)
        column = min(round(chart.x.share(curve.x[place]) * across), across - 1)
        dots[high : low + 1, column] = True
        dots[middle, max(0, column - 1) : column + 2] = True
    return dots


def _extent(x: FloatArray, y: FloatArray, across: int) -> tuple[FloatArray, FloatArray]:
    # Lowest and highest value in each column, or +∞ and −∞. `x` and `y`, [points], are shares of the axes
    at = (np.arange(across * _SAMPLES) + 0.5) / (across * _SAMPLES)
    half = 0.5 / across  # isolated points and end points need a column too
    inside = (at >= x[0] - half) & (at <= x[-1] + half)
    values = np.interp(at, x, y)
    low = np.where(inside, values, np.inf).reshape(across, _SAMPLES).min(axis=1)
    high = np.where(inside, values, -np.inf).reshape(across, _SAMPLES).max(axis=1)
    return low, high


def _styled_cells(
    codes: IntArray, owners: IntArray, curves: Sequence[ChartCurve], depth: Depth, ascii_only: bool
) -> str:
    text, start = "", 0
    changes = [*(np.flatnonzero(np.diff(owners)) + 1), len(owners)]
    for end in changes:
        owner = owners[start]
        part = "".join(map(chr, codes[start:end])).replace(chr(braille.BLANK), " ")
        if ascii_only and owner >= 0:
            part = _letter(owner) * len(part)
        text += part if owner < 0 else _coloured(part, curves[owner].colour, depth)
        start = end
    return text


def _names_by_row(chart: Chart) -> dict[int, int]:
    # Row → curve index: curves are named near their right end
    ends = []
    for curve in chart.curves:
        values = [value for value in curve.y if value is not None]
        ends.append(_row(min(max(chart.y.share(values[-1]), 0.0), 1.0)) if values else ROWS - 1)
    order = sorted(range(len(ends)), key=lambda place: ends[place])
    rows = spread([float(ends[place]) for place in order], 1.0, 0.0, ROWS - 1.0)
    taken: dict[int, int] = {}
    for place, row in zip(order, rows, strict=True):
        here = max(round(row), max(taken, default=-1) + 1)
        taken[here] = place
    return taken


def _letter(place: int) -> str:
    return ascii_letters[place % len(ascii_letters)]


def _row(share: float) -> int:
    dots = ROWS * braille.DOTS_DOWN - 1
    return round((1.0 - share) * dots) // braille.DOTS_DOWN


def _labels_below(chart: Chart, left: int, width: int) -> str:
    line = [" "] * (left + width + 1)
    free = 0
    for share, label in zip(chart.x.tick_shares, chart.x.labels, strict=True):
        start = min(max(left + round(share * (width - 1)) - len(label) // 2, 0), len(line) - len(label))
        if start >= free:
            line[start : start + len(label)] = label
            free = start + len(label) + 1
    return "".join(line).rstrip()


def _coloured(text: str, colour: int, depth: Depth) -> str:
    if depth == "none":
        return text
    colours: Sequence[str | int] = _COLOURS_16 if depth == "16" else COLOURS_256
    return click.style(text, fg=colours[colour % len(colours)])


# Recomputed figures of the book


def print_figure(
    figure: BookFigure, measured: MeasuredFigure, runs: int, *, with_picture: bool, err: bool
) -> None:
    """Print a recomputed figure of the book, on stdout or stderr."""
    click.echo(f"{figure.title}\n{BOOK}, {figure.source}\n{_runs(figure, runs)}\n", err=err)
    click.echo(columns([("", "book", "where", "ours", "agrees"), *_rows(measured)]), err=err)
    for note in measured.notes:
        click.echo(f"\n{note}", err=err)
    if with_picture:
        click.echo(err=err)
        print_picture(measured.picture, err=err)


def _runs(figure: BookFigure, runs: int) -> str:
    if figure.book_runs is None:
        return f"means of {counted(runs, 'run')}; the book does not give its number of runs"
    book = "as in the book" if runs == figure.book_runs else f"in the book of {figure.book_runs:,}"
    return f"means of {counted(runs, 'run')}, {book}"


def _rows(measured: MeasuredFigure) -> Iterator[tuple[str, ...]]:
    for each in measured.table:
        yield each.what, each.book, each.place, _ours(each), "yes" if each.agrees else "no"


def _ours(each: BookComparison) -> str:
    if each.ours is None or each.stderr is None:
        return number(each.ours, ".4g")
    mean, error = alike([each.ours, each.stderr])
    return f"{mean} ± {error}"
