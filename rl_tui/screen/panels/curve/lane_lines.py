"""The lines of runs side by side, which areas would hide, and of one run over the band of many seeds."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

from rl_tui.screen.draw import braille
from rl_tui.screen.draw.chart_plot import Plot
from rl_tui.screen.panels.curve.data import CurveData
from rl_tui.screen.theme.look import Look

_TURN: Final = 2  # columns in which one of several lines in the same cells is seen
_MARKS_APART: Final = 16  # columns from one number on a line to the next
_LaneCodes = npt.NDArray[np.int64]


class LaneCells(NamedTuple):
    """What is in each cell, [rows, columns]: the code of its character, 0 for none.

    ``line`` tells whose it is: −1 no line's, 0 the greedy line's, n that of run n.
    """

    codes: _LaneCodes
    line: _LaneCodes


def lane_cells(plot: Plot, data: CurveData, look: Look) -> LaneCells:
    """Return the mean of every run, and of the run shown the greedy line."""
    layers = _in_braille(plot, data) if look.glyphs.braille else _in_ascii(plot, data)
    there = layers > 0
    line = _whose(_with_greedy_behind(there))
    codes = np.take_along_axis(layers, np.maximum(line, 0)[None], axis=0)[0]
    codes[line < 0] = 0
    if data.lanes and look.glyphs.braille and not look.palette.tells_lanes_apart:
        _mark(codes, line, there)
    return LaneCells(codes, line)


def _in_braille(plot: Plot, data: CurveData) -> _LaneCodes:
    """Return the characters of greedy line and runs, [1 + runs, rows, columns]."""
    codes = np.stack([plot.braille_line(line) for line in data.lines])
    return np.where(codes > braille.BLANK, codes, 0)


def _in_ascii(plot: Plot, data: CurveData) -> _LaneCodes:
    """Return a letter for the greedy line and for each run its number."""
    dots = np.stack([plot.line_dots(line, plot.columns, plot.rows) for line in data.lines])
    signs = np.array([ord("o"), *(ord(str(number)) for number in range(1, len(data.lines)))])
    return np.asarray(dots * signs[:, None, None])


def _with_greedy_behind(there: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
    """Return the cells of lines, [lines, rows, columns], where the greedy one goes behind the runs.

    That is where it goes up and down: passing through many policies, it would cover all else.
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
    """Write the number of each run on its line now and then, in columns of its own."""
    lanes = len(there) - 1
    for number in range(1, lanes + 1):
        first = (number - 1) * _MARKS_APART // lanes + 1
        for column in range(first, codes.shape[1], _MARKS_APART):
            rows = np.flatnonzero(there[number, :, column])
            if len(rows):
                codes[rows[0], column], line[rows[0], column] = ord(str(number)), number
