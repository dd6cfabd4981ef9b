"""The lines of runs side by side as characters: each in its colour, or with its number on it."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

from rl_tui.tui.draw import braille
from rl_tui.tui.draw.chart_plot import Plot
from rl_tui.tui.panels.curve.chart_band import edge_codes
from rl_tui.tui.panels.curve.data import CurveData
from rl_tui.tui.theme.look import Look

_TURN: Final = 2  # columns in which one of several lines in the same cells is seen
_MARKS_APART: Final = 16  # columns from one number on a line to the next
_Codes = npt.NDArray[np.int64]


class LaneCells(NamedTuple):
    """What is in each cell, [rows, columns]: the code of its character, 0 where there is none.

    ``line`` tells whose it is: −1 no line's, 0 the greedy line's, n that of lane n. ``band`` has the
    characters of the edges of the band of the lane shown.
    """

    codes: _Codes
    line: _Codes
    band: _Codes


def lane_cells(plot: Plot, data: CurveData, look: Look) -> LaneCells:
    """Return the mean of every lane, and of the lane shown the greedy line and the band."""
    draw = _braille if look.glyphs.braille else _ascii
    layers, band = draw(plot, data)
    there = layers > 0
    line = _whose(_with_greedy_behind(there))
    codes = np.take_along_axis(layers, np.maximum(line, 0)[None], axis=0)[0]
    codes[line < 0] = 0
    if look.glyphs.braille and not look.palette.tells_lanes_apart:
        _mark(codes, line, there)
    return LaneCells(codes, line, band)


def _braille(plot: Plot, data: CurveData) -> tuple[_Codes, _Codes]:
    """Return the characters of greedy line and lanes, [1 + lanes, rows, columns], and those of the band."""
    layers = [_blank_as_none(plot.braille_line(line)) for line in data.lines]
    return np.stack(layers), edge_codes(plot, data.band)


def _ascii(plot: Plot, data: CurveData) -> tuple[_Codes, _Codes]:
    """Return a star for the greedy line and for each lane its number; no band, as in a single run's chart."""
    dots = np.stack([plot.line_dots(line, plot.columns, plot.rows) for line in data.lines])
    signs = np.array([ord("*"), *(ord(str(lane.number)) for lane in data.lanes)])
    return dots * signs[:, None, None], np.zeros(dots.shape[1:], dtype=np.int64)


def _blank_as_none(codes: _Codes) -> _Codes:
    return np.where(codes > braille.BLANK, codes, 0)


def _with_greedy_behind(there: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
    """Return the cells of lines, [lines, rows, columns], where the greedy one goes behind the lanes.

    That is where it goes up and down: as many policies as it passes through, it would cover all else.
    """
    goes_up_or_down = there[0].sum(axis=0) > 1
    behind = there[1:].any(axis=0) & goes_up_or_down
    return np.concatenate(((there[0] & ~behind)[None], there[1:]))


def _whose(there: npt.NDArray[np.bool_]) -> _Codes:
    """Return which of the lines that are ``there``, [lines, rows, columns], each cell shows; −1: none.

    Lines that share cells take turns, so that none hides another.
    """
    among = np.cumsum(there, axis=0)
    count = among[-1]
    turn = np.arange(there.shape[2]) // _TURN % np.maximum(count, 1)
    chosen = there & (among == turn + 1)
    return np.where(count > 0, chosen.argmax(axis=0), -1)


def _mark(codes: _Codes, line: _Codes, there: npt.NDArray[np.bool_]) -> None:
    """Write the number of each lane on its line now and then, in columns of its own."""
    lanes = len(there) - 1
    for number in range(1, lanes + 1):
        first = (number - 1) * _MARKS_APART // lanes + 1
        for column in range(first, codes.shape[1], _MARKS_APART):
            rows = np.flatnonzero(there[number, :, column])
            if len(rows):
                codes[rows[0], column], line[rows[0], column] = ord(str(number)), number
