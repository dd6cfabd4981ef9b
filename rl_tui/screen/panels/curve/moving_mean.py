"""The moving mean that the curve draws."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from rl_tui.runs.history import RECENT
from rl_tui.runs.results import Curve
from rl_tui.screen.draw.braille import Steps
from rl_tui.worlds.mdp.space import FloatArray, IntArray

_LEAST_WINDOW: Final = 10
_WINDOWS: Final = 20  # on the axis


@dataclass(frozen=True, slots=True, eq=False)
class MovingMean:
    """The mean of the last ``window`` episodes at any moment.

    ``end`` and ``total``, [B + 1]: last episode of each bin, and the sum up to it.
    """

    end: FloatArray
    total: FloatArray
    window: int

    @property
    def finished(self) -> float:
        """The number of episodes."""
        return float(self.end[-1])

    def at(self, episode: FloatArray) -> FloatArray:
        """Return the means after ``episode`` episodes, whole numbers ≥ 1."""
        since = np.maximum(episode - self.window, 0.0)
        sums = np.interp(episode, self.end, self.total) - np.interp(since, self.end, self.total)
        return np.asarray(sums / (episode - since))

    @property
    def means(self) -> FloatArray:
        """The means at each bin's end, [B]."""
        return self.at(self.end[1:])

    @property
    def line(self) -> Steps:
        """The means as a line."""
        return Steps(self.end[:-1], self.end[1:], self.means, self.means)

    def now(self, last_100: float | None) -> float | None:
        """Return the last mean. ``last_100`` is exact where bins are not."""
        is_other = len(self.end) > 1 and self.window != RECENT
        return float(self.means[-1]) if is_other else last_100


def moving_mean(ends: IntArray | FloatArray, mean: FloatArray, window: int) -> MovingMean:
    """Compute the moving mean of ``mean``, [B], of bins up to ``ends``, [B]."""
    total = np.concatenate(([0.0], np.cumsum(mean * np.diff(ends, prepend=0))))
    return MovingMean(np.concatenate(([0.0], ends)), total, window)


def window_of(curves: Sequence[Curve], right: float, *, is_compared: bool) -> int:
    """Return the common window: at least a bin, else 1/20 of the axis and at most 100 episodes.

    ``is_compared``: always 100, as in the numbers beside other runs or seeds.
    """
    window = RECENT if is_compared else int(min(RECENT, max(_LEAST_WINDOW, right // _WINDOWS)))
    return max(window, *(int(each.episode[0]) for each in curves if len(each.episode)), 0)
