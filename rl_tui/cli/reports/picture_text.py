"""A picture in the terminal: curves of braille dots, atlases of cells with numbers."""

from __future__ import annotations

import os
import shutil
import sys
from collections.abc import Iterator, Sequence
from string import ascii_letters
from textwrap import fill
from typing import TYPE_CHECKING, Final

import click
import numpy as np

from rl_tui.cli.reports.atlas_text import atlas_lines
from rl_tui.lab.pictures.chart_layout import spread
from rl_tui.lab.pictures.picture import Chart, ChartCurve, Picture
from rl_tui.tui.draw import braille
from rl_tui.tui.draw.canvas import shortened
from rl_tui.tui.draw.to_ascii import to_ascii
from rl_tui.tui.theme.depth import can_encode, depth_of
from rl_tui.tui.theme.glyphs import ASCII

if TYPE_CHECKING:
    from rl_tui.tui.theme.palette import Depth
    from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray

ROWS: Final = 16
_LEAST_COLUMNS: Final = 20
_WIDEST: Final = 120
_MOST_NAME: Final = 34
_SAMPLES: Final = 8  # values of a curve that are looked at for each column of dots
_DASH: Final = 3  # columns of dots that a dashed line shows and leaves out in turn
# Readable on black and on white, and told apart by colour-blind eyes
COLOURS_256: Final = (32, 172, 93, 161, 139, 94)
_COLOURS_16: Final = ("blue", "yellow", "magenta", "red", "cyan", "green")


def print_picture(picture: Picture, *, err: bool = False) -> None:
    """Print ``picture`` on stdout or stderr, as wide as the terminal, with its colours and characters."""
    stream = sys.stderr if err else sys.stdout
    is_terminal = stream.isatty()
    columns = shutil.get_terminal_size().columns if is_terminal else 80
    depth = depth_of("auto", os.environ) if is_terminal else "none"
    ascii_only = not can_encode(getattr(stream, "encoding", None))
    click.echo(picture_text(picture, min(columns, _WIDEST), depth, ascii_only=ascii_only), err=err)


def picture_text(picture: Picture, columns: int, depth: Depth = "none", *, ascii_only: bool = False) -> str:
    """Return ``picture`` as lines of at most ``columns`` cells, with escape sequences for colours.

    Where there are but ASCII characters, each curve is drawn with a letter of its own.
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
    return to_ascii(text, ASCII) if ascii_only else text


def _chart_lines(chart: Chart, columns: int, depth: Depth, ascii_only: bool) -> Iterator[str]:
    names = [shortened(curve.name, min(_MOST_NAME, columns // 3), "…") for curve in chart.curves]
    if ascii_only:
        names = [to_ascii(f"{_letter(place)} {name}", ASCII) for place, name in enumerate(names)]
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
    """Return the characters of the plot and whose curve each cell is, both [rows, width]; −1 for none's."""
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
    """Return ``dots`` with those of each point of ``curve`` and of its interval."""
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
    """Return the least and the largest value of the line through the points in each of ``across`` columns.

    A column without the line gets +∞ and −∞. ``x`` and ``y`` are shares of the axes, [points].
    """
    at = (np.arange(across * _SAMPLES) + 0.5) / (across * _SAMPLES)
    half = 0.5 / across  # a point of its own, or at the very end, has a column too
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
    """Return in which row beside the plot each curve is named, near its right end: its place by row."""
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
