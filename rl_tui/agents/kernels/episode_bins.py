"""Finished episodes in bins of equal width, for learning curves."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from rl_tui.agents.kernels.compiled import compiled_for
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray


class EpisodeBins(NamedTuple):
    """Bins of `width` episodes. The first `used` are full, except the last."""

    width: IntArray
    used: IntArray
    episodes: IntArray
    return_sum: FloatArray
    return_low: FloatArray
    return_high: FloatArray
    length_sum: IntArray
    total_return: FloatArray


def _no_episodes() -> tuple[Any, ...]:
    return empty_bins(2), np.empty(0), np.empty(0, np.int64)


@compiled_for(_no_episodes)
def fold(bins: EpisodeBins, returns: FloatArray, lengths: IntArray) -> None:
    """Add finished episodes. When all bins are full, merge them in pairs."""
    width, used = bins.width[0], bins.used[0]
    total = bins.total_return[0]
    done = 0
    while done < len(returns):
        if used == 0 or bins.episodes[used - 1] == width:
            if used == len(bins.episodes):
                used //= 2
                width *= 2
                for to in range(used):
                    left, right = 2 * to, 2 * to + 1
                    bins.episodes[to] = bins.episodes[left] + bins.episodes[right]
                    bins.return_sum[to] = bins.return_sum[left] + bins.return_sum[right]
                    bins.return_low[to] = min(bins.return_low[left], bins.return_low[right])
                    bins.return_high[to] = max(bins.return_high[left], bins.return_high[right])
                    bins.length_sum[to] = bins.length_sum[left] + bins.length_sum[right]
            bins.episodes[used] = 0
            bins.return_sum[used] = 0.0
            bins.return_low[used] = math.inf
            bins.return_high[used] = -math.inf
            bins.length_sum[used] = 0
            used += 1
        here = used - 1
        until = min(len(returns), done + width - bins.episodes[here])
        return_sum, low, high = bins.return_sum[here], bins.return_low[here], bins.return_high[here]
        length_sum = bins.length_sum[here]
        for episode in range(done, until):
            value = returns[episode]
            total += value
            return_sum += value
            low = min(low, value)
            high = max(high, value)
            length_sum += lengths[episode]
        bins.episodes[here] += until - done
        bins.return_sum[here], bins.return_low[here], bins.return_high[here] = return_sum, low, high
        bins.length_sum[here] = length_sum
        done = until
    bins.width[0], bins.used[0] = width, used
    bins.total_return[0] = total


def empty_bins(bins: int) -> EpisodeBins:
    """Return an even number of empty bins of one episode each."""
    return EpisodeBins(
        width=np.ones(1, np.int64),
        used=np.zeros(1, np.int64),
        episodes=np.zeros(bins, np.int64),
        return_sum=np.zeros(bins),
        return_low=np.zeros(bins),
        return_high=np.zeros(bins),
        length_sum=np.zeros(bins, np.int64),
        total_return=np.zeros(1),
    )


class CurveSums(NamedTuple):
    """Sums of each bin, [B]: returns, lengths and optimal actions."""

    returns: FloatArray
    lengths: IntArray
    optimal: IntArray


def _nothing_to_collect() -> tuple[Any, ...]:
    sums = CurveSums(np.zeros(1), np.zeros(1, np.int64), np.zeros(1, np.int64))
    return sums, 1, 0, np.empty(0), np.empty(0, np.int64), np.empty(0, np.bool_)


@compiled_for(_nothing_to_collect)
def collect(
    sums: CurveSums,
    width: int,
    done: int,
    returns: FloatArray,
    lengths: IntArray,
    optimal: BoolArray,
) -> None:
    """Add episodes, which follow `done` earlier ones, to their bins."""
    for index in range(len(returns)):
        here = (done + index) // width
        sums.returns[here] += returns[index]
        sums.lengths[here] += lengths[index]
        sums.optimal[here] += optimal[index]
