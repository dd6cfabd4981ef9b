"""Returns and lengths of any number of episodes in bounded memory."""

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
    """Finished episodes in at most ``bins`` bins of equal width, merged in pairs when all are full.

    Sums are added in the order of the episodes, so that how they were delivered does not show. The last 100
    episodes are kept as they are, and so are the lengths of the first 100. For quartiles, single returns are
    kept too: of every episode, of every second one, every fourth and so on, so that there are at most eight
    for each of ``bins``, an even number.
    """

    def __init__(self, bins: int = BINS) -> None:
        self._bins = empty_bins(bins)
        self._count, self._every = 0, 1  # episodes, and the distance of two kept returns
        self._samples: FloatArray = np.empty(0)
        self._recent_returns: FloatArray = np.empty(0)
        self._recent_lengths: IntArray = np.empty(0, np.int64)
        self._first_lengths: IntArray = np.empty(0, np.int64)

    def add(self, returns: FloatArray, lengths: IntArray) -> None:
        """Add finished episodes, [n] each, in order."""
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
        """The sum of all returns: the winnings of a bandit."""
        return float(self._bins.total_return[0])

    @property
    def last_100(self) -> tuple[float, float] | tuple[None, None]:
        """The mean return and the mean length in steps of the last 100 episodes, or of as many as there are.

        None before the first has ended.
        """
        count = len(self._recent_returns)
        if not count:
            return None, None
        return math.fsum(self._recent_returns) / count, math.fsum(self._recent_lengths) / count

    @property
    def newest(self) -> tuple[float, int] | None:
        """Return and length in steps of the episode that ended last; None before the first has ended."""
        if not len(self._recent_returns):
            return None
        return float(self._recent_returns[-1]), int(self._recent_lengths[-1])

    @property
    def first_lengths(self) -> IntArray:
        """[n], the lengths in steps of the first episodes, of 100 at most."""
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
        """Return copies of all that is kept: the bins, single returns, and the last and first episodes."""
        sampled = np.array((self._count, self._every))
        kept = (sampled, self._samples, self._recent_returns, self._recent_lengths, self._first_lengths)
        return copies((*self._bins, *kept))

    def restore(self, state: Arrays) -> None:
        """Go back to what :meth:`checkpoint` returned, from a history of as many bins."""
        # what is no bin is never written to
        *bins, sampled, self._samples, self._recent_returns, self._recent_lengths, self._first_lengths = state
        put_back(self._bins, tuple(bins))
        self._count, self._every = map(int, sampled)
