"""Values and episodes as cells and dots."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from rl_tui.screen.draw import braille
from rl_tui.screen.draw.braille import Steps
from rl_tui.screen.draw.scale import Scale
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray


class Plot(NamedTuple):
    """The area of the curves: first column, cells, and episodes 0 .. ``right``."""

    left: int
    columns: int
    rows: int
    right: float
    scale: Scale

    @property
    def top(self) -> float:
        """The uppermost dot's value."""
        above = braille.DOTS_DOWN - 1 if self.rows > 1 else 0
        per_dot = (self.scale.high - self.scale.low) / (self.rows * braille.DOTS_DOWN - 1 - above)
        return self.scale.high + above * per_dot

    def column(self, episode: float) -> int:
        """Return an episode's column, from 0."""
        return int(episode / self.right * self.columns)

    def ends_of_columns(self, finished: float) -> FloatArray:
        """Return each column's last episode, [columns], NaN after ``finished``."""
        edges = np.arange(self.columns + 1) * (self.right / self.columns)
        ends = np.clip(np.ceil(edges[1:] - 1e-9), 1.0, max(1.0, finished))
        return np.where(edges[:-1] < finished, ends, np.nan)

    def row(self, value: float) -> int:
        """Return the row, within the chart."""
        return self._dot(value) // braille.DOTS_DOWN

    def level_code(self, value: float) -> int:
        """Return a level line's code point."""
        return braille.LEVELS[self._dot(value) % braille.DOTS_DOWN]

    def _dot(self, value: float) -> int:
        last = self.rows * braille.DOTS_DOWN - 1
        dot = round((self.top - max(value, self.scale.low)) / (self.top - self.scale.low) * last)
        return min(max(dot, 0), last)

    def braille_line(self, line: Steps) -> IntArray:
        """Return the code points, [rows, columns]."""
        columns, rows = self.columns * braille.DOTS_ACROSS, self.rows * braille.DOTS_DOWN
        return braille.braille_codes(self.line_dots(line, columns, rows))

    def halves(self, line: Steps) -> IntArray:
        """Return the halves of cells in ``line``, [rows, columns]: 1 upper, 2 lower, 3 both."""
        halves = self.line_dots(line, self.columns, 2 * self.rows).astype(np.int64)
        return halves[::2] + 2 * halves[1::2]

    def below(self, line: Steps) -> BoolArray:
        """Return which columns, [columns], go below the axis."""
        if not (line.low < self.scale.low).any():
            return np.zeros(self.columns, dtype=np.bool_)
        rows = self.rows * braille.DOTS_DOWN
        return np.asarray(self._span(line, self.columns, rows).bottom >= rows)

    def has_gap(self, line: Steps) -> bool:
        """Return whether ``line`` has an inner gap."""
        if not len(line.end):
            return False
        low, high = braille.decimated(line, self.right, self.columns)
        behind = min(self.columns, math.ceil(float(line.end[-1]) / self.right * self.columns))
        return bool((low > high)[self.column(float(line.start[0])) : behind].any())

    def stepped(self, line: Steps) -> Steps:
        """Return ``line`` with one value a column, its last one there."""
        if not len(line.end):
            return line
        edges = np.linspace(0.0, self.right, self.columns + 1)
        behind = np.searchsorted(line.start, edges[1:], side="left")
        known = np.maximum.accumulate(np.where(np.isnan(line.low), 0, np.arange(1, len(line.low) + 1)))
        last = np.where(behind > 0, known[behind - 1], 0) - 1
        value = np.where((last >= 0) & (line.end[last] >= edges[:-1]), line.low[last], np.nan)
        margin = 0.1 * self.right / self.columns  # keeps neighbours from touching
        return Steps(edges[:-1] + margin, edges[1:] - margin, value, value)

    def line_dots(self, line: Steps, columns: int, rows: int) -> BoolArray:
        """Return the dots of ``line``, [rows, columns] of dots."""
        return braille.dots_of(braille.joined(self._span(line, columns, rows)), rows)

    def filled_dots(self, band: Steps, columns: int, rows: int) -> BoolArray:
        """Return the dots inside ``band``, [rows, columns] of dots."""
        return braille.dots_of(self._span(band, columns, rows), rows)

    def _span(self, line: Steps, columns: int, rows: int) -> braille.Span:
        low, high = braille.decimated(line, self.right, columns)
        return braille.span(low, high, self.scale.low, self.top, rows)
