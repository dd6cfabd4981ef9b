"""Where values and episodes of a chart stand among its cells and dots."""

from __future__ import annotations

from typing import NamedTuple

from rl_tui.tui.draw import braille
from rl_tui.tui.draw.braille import Steps
from rl_tui.tui.draw.scale import Scale


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

    def span(self, line: Steps, columns: int, rows: int) -> braille.Span:
        """Return the dots of ``line`` where there are columns × rows of them."""
        low, high = braille.decimated(line, self.right, columns)
        return braille.span(low, high, self.scale.low, self.top, rows)
