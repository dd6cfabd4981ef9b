"""The summary of a run's episodes, of constant size."""

from __future__ import annotations

from typing import Any, Final, NamedTuple

import numpy as np

from rl_tui.agents.batches.rows import stacked
from rl_tui.agents.kernels.compiled import compiled_for, for_kernels
from rl_tui.agents.kernels.episode_bins import CurveSums
from rl_tui.agents.kernels.position import EpisodeLog
from rl_tui.worlds.mdp.space import FloatArray, IntArray

RECENT: Final = 100
"""Number of recent episodes that are stored individually."""


class Digest(NamedTuple):
    """Summary of the finished episodes of a run.

    Ring buffers are `recent_returns` and `recent_lengths`, [100]: episode k (from 0) is at k modulo 100. The
    first `episodes` are in `curve`, in bins of `width`.
    """

    total_return: FloatArray
    recent_returns: FloatArray
    recent_lengths: IntArray
    curve: CurveSums
    episodes: int
    width: int


def new_digest(episodes: int, width: int) -> Digest:
    """Return an empty summary."""
    bins = -(-episodes // width)
    return Digest(
        np.zeros(1),
        np.zeros(RECENT),
        np.zeros(RECENT, np.int64),
        CurveSums(np.zeros(bins), np.zeros(bins, np.int64), np.zeros(bins, np.int64)),
        episodes,
        width,
    )


@for_kernels
def digest_episodes(digest: Digest, log: EpisodeLog, done: int) -> None:
    """Add the episodes after `done` earlier ones, in the order of a single run."""
    total, curve = digest.total_return[0], digest.curve
    for index in range(log.finished[0]):
        episode = done + index
        total += log.returns[index]
        digest.recent_returns[episode % RECENT] = log.returns[index]
        digest.recent_lengths[episode % RECENT] = log.lengths[index]
        if episode < digest.episodes:
            here = episode // digest.width
            curve.returns[here] += log.returns[index]
            curve.lengths[here] += log.lengths[index]
            curve.optimal[here] += log.optimal[index]
    digest.total_return[0] = total


def _one_run() -> tuple[Any, ...]:
    return stacked([new_digest(0, 1)], [1]), np.zeros((1, 2), np.int64)[:, 0], np.zeros(1), np.zeros(1)


@compiled_for(_one_run)
def mean_recent(digest: Digest, episodes: IntArray, returns: FloatArray, lengths: FloatArray) -> None:
    """Write mean return and mean length of the recent episodes of each run, [B].

    If a sum of returns is not exact, the mean is inf, and the caller sums exactly. The test uses the error of
    each addition (D. E. Knuth, The Art of Computer Programming, vol. 2, 4.2.2, theorem B).
    """
    for run in range(len(episodes)):
        count = min(episodes[run], RECENT)
        total, length, is_exact = 0.0, 0, True
        for place in range(count):
            each = digest.recent_returns[run, place]
            added = total + each
            rest = added - total
            is_exact = is_exact and (total - (added - rest)) + (each - rest) == 0.0
            total = added
            length += digest.recent_lengths[run, place]
        if count > 0:
            returns[run] = total / count if is_exact else np.inf
            lengths[run] = length / count
