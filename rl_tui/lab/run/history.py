"""Returns and lengths of any number of episodes in bounded memory."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from rl_tui.agents.kernels.episode_bins import empty_bins, fold
from rl_tui.lab.run.results import Curve
from rl_tui.worlds.mdp.space import FloatArray, IntArray

BINS: Final = 512
RECENT: Final = 100


@dataclass(frozen=True, slots=True, eq=False)
class HistoryState:
    """A copy of a history, for checkpoints."""

    arrays: tuple[IntArray | FloatArray, ...]
    recent_returns: FloatArray
    recent_lengths: IntArray

    @property
    def nbytes(self) -> int:
        """How much memory it takes."""
        return sum(each.nbytes for each in (*self.arrays, self.recent_returns, self.recent_lengths))


class History:
    """Finished episodes in at most ``bins`` bins of equal width, merged in pairs when all are full.

    Sums are added in the order of the episodes, so that how they were delivered does not show. The last 100
    episodes are kept as they are. ``bins`` is even.
    """

    def __init__(self, bins: int = BINS) -> None:
        self._bins = empty_bins(bins)
        self._recent_returns: FloatArray = np.empty(0)
        self._recent_lengths: IntArray = np.empty(0, np.int64)

    def add(self, returns: FloatArray, lengths: IntArray) -> None:
        """Add finished episodes, [n] each, in order."""
        fold(self._bins, returns, lengths)
        self._recent_returns = np.concatenate((self._recent_returns, returns[-RECENT:]))[-RECENT:]
        self._recent_lengths = np.concatenate((self._recent_lengths, lengths[-RECENT:]))[-RECENT:]

    def warm_up(self) -> None:
        """Compile what is compiled, or read it from its cache."""
        self.add(np.empty(0), np.empty(0, np.int64))

    @property
    def episodes(self) -> int:
        """How many episodes were added."""
        return int(self._bins.episodes[: self._bins.used[0]].sum())

    @property
    def total_return(self) -> float:
        """The sum of all returns: the winnings of a bandit."""
        return float(self._bins.total_return[0])

    @property
    def return_last_100(self) -> float | None:
        """The mean return of the last 100 episodes (of all, while there are fewer); None before the first."""
        return _mean(self._recent_returns)

    @property
    def length_last_100(self) -> float | None:
        """The mean length of the last 100 episodes in steps; None before the first."""
        return _mean(self._recent_lengths)

    def curve(self) -> Curve:
        """Return the bins in use."""
        used = slice(0, int(self._bins.used[0]))
        count = self._bins.episodes[used]
        return Curve(
            episode=np.cumsum(count),
            return_mean=self._bins.return_sum[used] / count,
            return_low=self._bins.return_low[used].copy(),
            return_high=self._bins.return_high[used].copy(),
            length_mean=self._bins.length_sum[used] / count,
        )

    def checkpoint(self) -> HistoryState:
        """Return a copy of all that is kept."""
        return HistoryState(
            tuple(array.copy() for array in self._bins),
            self._recent_returns.copy(),
            self._recent_lengths.copy(),
        )

    def restore(self, state: HistoryState) -> None:
        """Go back to what :meth:`checkpoint` returned, from a history of as many bins."""
        for array, saved in zip(self._bins, state.arrays, strict=True):
            array[:] = saved
        self._recent_returns = state.recent_returns.copy()
        self._recent_lengths = state.recent_lengths.copy()


def _mean(values: FloatArray | IntArray) -> float | None:
    return math.fsum(values) / len(values) if len(values) else None
