"""Returns and lengths of all episodes in bounded memory."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from rl_tui.agents.kernels.episode_bins import empty_bins, fold
from rl_tui.agents.kernels.machine_code import fastest
from rl_tui.agents.learner_memory import Arrays, copies, put_back
from rl_tui.runs.results import Curve
from rl_tui.worlds.mdp.space import FloatArray, IntArray

BINS: Final = 512
RECENT: Final = 100
FIRST: Final = 100
_SAMPLES_A_BIN: Final = 8


class History:
    """Finished episodes in at most `bins` bins (an even number), which are merged in pairs once full.

    The last 100 episodes, the first 100 lengths and, for quartiles, the returns of every 2ⁿ-th episode (at
    most eight per bin) are stored too.
    """

    def __init__(self, bins: int = BINS) -> None:
        self._bins = empty_bins(bins)
        self._count, self._every = 0, 1  # episodes, and the distance between two stored returns
        self._samples: FloatArray = np.empty(0)
        self._recent_returns: FloatArray = np.empty(0)
        self._recent_lengths: IntArray = np.empty(0, np.int64)
        self._first_lengths: IntArray = np.empty(0, np.int64)

    def add(self, returns: FloatArray, lengths: IntArray) -> None:
        """Add returns and lengths of finished episodes, `[n]`, in order."""
        before, done = self._every, self._count
        self._count += len(returns)
        while self._count > _SAMPLES_A_BIN * len(self._bins.episodes) * self._every:
            self._every *= 2
        new = returns[-done % self._every :: self._every]
        self._samples = np.concatenate((self._samples[:: self._every // before], new))
        fastest(fold)(self._bins, returns, lengths)
        self._recent_returns = np.concatenate((self._recent_returns, returns[-RECENT:]))[-RECENT:]
        self._recent_lengths = np.concatenate((self._recent_lengths, lengths[-RECENT:]))[-RECENT:]
        if len(self._first_lengths) < FIRST:
            self._first_lengths = np.concatenate((self._first_lengths, lengths[:FIRST]))[:FIRST]

    @property
    def total_return(self) -> float:
        """Sum of all returns."""
        return float(self._bins.total_return[0])

    @property
    def last_100(self) -> tuple[float, float] | tuple[None, None]:
        """Mean return and length of the last 100 episodes or fewer, or None."""
        count = len(self._recent_returns)
        if not count:
            return None, None
        return math.fsum(self._recent_returns) / count, math.fsum(self._recent_lengths) / count

    @property
    def newest(self) -> tuple[float, int] | None:
        """Return and length of the last finished episode, or None."""
        if not len(self._recent_returns):
            return None
        return float(self._recent_returns[-1]), int(self._recent_lengths[-1])

    @property
    def first_lengths(self) -> IntArray:
        """Lengths of the first 100 episodes or fewer, `[n]`."""
        return self._first_lengths

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
            samples=self._samples,
            sample_every=self._every,
        )

    def checkpoint(self) -> Arrays:
        """Return copies of the state."""
        sampled = np.array((self._count, self._every))
        kept = (sampled, self._samples, self._recent_returns, self._recent_lengths, self._first_lengths)
        return copies((*self._bins, *kept))

    def restore(self, state: Arrays) -> None:
        """Restore the state from `checkpoint` (equally many bins)."""
        # only the bins are written in place, so the other arrays may be shared
        *bins, sampled, self._samples, self._recent_returns, self._recent_lengths, self._first_lengths = state
        put_back(self._bins, tuple(bins))
        self._count, self._every = map(int, sampled)
