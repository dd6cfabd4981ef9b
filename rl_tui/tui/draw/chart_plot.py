"""Where values and episodes of a chart stand among its cells and dots."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rl_tui.tui.draw import braille
from rl_tui.tui.draw.braille import Steps
from rl_tui.tui.draw.scale import Scale
from rl_tui.worlds.mdp.space import BoolArray, IntArray


class Plot(NamedTuple):
    """Where the curves are: from column ``left``, ``columns`` × ``rows`` cells, episodes 0 .. ``right``."""

    left: int
    columns: int
    rows: int
    right: float
    scale: Scale

    @property
    def top(self) -> float:
        """The value of the uppermost dot.

        The highest label has the lowest dots of its row: a line somewhat below it then has a row of its own.
        """
        above = braille.DOTS_DOWN - 1
        per_dot = (self.scale.high - self.scale.low) / (self.rows * braille.DOTS_DOWN - 1 - above)
        return self.scale.high + above * per_dot

    def column(self, episode: float) -> int:
        """Return the column, from 0, of an episode."""
        return int(episode / self.right * self.columns)

    def row(self, value: float) -> int:
        """Return the row of ``value``, placed as dots are, so that labels stand beside their lines."""
        last = self.rows * braille.DOTS_DOWN - 1
        dot = round((self.top - value) / (self.top - self.scale.low) * last)
        return min(max(dot, 0), last) // braille.DOTS_DOWN

    def braille_line(self, line: Steps) -> IntArray:
        """Return the characters of ``line``, [rows, columns], braille.BLANK where it does not go."""
        columns, rows = self.columns * braille.DOTS_ACROSS, self.rows * braille.DOTS_DOWN
        return braille.braille_codes(self.line_dots(line, columns, rows))

    def braille_band(self, band: Steps) -> IntArray:
        """Return the characters of a shade, [rows, columns], braille.BLANK where there is none."""
        columns, rows = self.columns * braille.DOTS_ACROSS, self.rows * braille.DOTS_DOWN
        dots = braille.dots_of(self._span(band, columns, rows), rows)
        return braille.braille_codes(braille.stipple(dots))

    def halves(self, line: Steps) -> IntArray:
        """Return which half of a cell ``line`` takes, [rows, columns]: 1 the upper, 2 the lower, 3 both."""
        dots = self.line_dots(line, self.columns, 2 * self.rows).astype(np.int64)
        return dots[::2] + 2 * dots[1::2]

    def line_dots(self, line: Steps, columns: int, rows: int) -> BoolArray:
        """Return the dots of ``line`` where there are columns × rows of them, [rows, columns]."""
        return braille.dots_of(braille.joined(self._span(line, columns, rows)), rows)

    def filled_dots(self, band: Steps, columns: int, rows: int) -> BoolArray:
        """Return the dots from the lowest to the highest of ``band``, as :meth:`line_dots` does."""
        return braille.dots_of(self._span(band, columns, rows), rows)

    def _span(self, line: Steps, columns: int, rows: int) -> braille.Span:
        low, high = braille.decimated(line, self.right, columns)
        return braille.span(low, high, self.scale.low, self.top, rows)
