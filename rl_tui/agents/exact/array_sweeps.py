"""Sweeps over all states by whole arrays: what the kernels of backward induction do, without a compiler.

They add in the order in which the kernels do, so that the bits are the same: the first outcome of every pair,
then the second of every pair that has one, and so on; and likewise the pairs of every state.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from rl_tui.worlds.mdp.space import FloatArray, IntArray


class Model(NamedTuple):
    """What a sweep over all states reads: the expected reward of each pair, [P], and outcomes' weights, [O].

    The ``weight`` of an outcome is that of the value of the state it leads to: 0 where the episode ends.
    """

    first_pair: IntArray
    first_outcome: IntArray
    next_state: IntArray
    pair_reward: FloatArray
    weight: FloatArray


class Rank(NamedTuple):
    """The k-th part of each owner that has so many: the owners, and their k-th parts, [n] each."""

    owners: IntArray
    parts: IntArray


Sweep = Callable[[FloatArray], FloatArray]
"""Returns the values of all states, [S], one step earlier than those it is given, [S]."""


def following(model: Model, policy: FloatArray) -> Sweep:
    """Return the sweep that follows ``policy``, [P] (equation 4.4)."""
    outcomes = list(_ranks(model.first_outcome))
    pairs = [_of_those_taken(rank, policy) for rank in _ranks(model.first_pair)]

    def sweep(later: FloatArray) -> FloatArray:
        total = _pair_values(model, outcomes, later)
        values = np.zeros(len(later))
        for owners, parts in pairs:
            values[owners] += policy[parts] * total[parts]
        return values

    return sweep


def optimising(model: Model) -> Sweep:
    """Return the sweep that takes the best pair of each state (equation 4.10)."""
    outcomes, pairs = list(_ranks(model.first_outcome)), list(_ranks(model.first_pair))

    def sweep(later: FloatArray) -> FloatArray:
        total = _pair_values(model, outcomes, later)
        values = np.zeros(len(later))
        for number, (owners, parts) in enumerate(pairs):
            better = (total[parts] > values[owners]) | (number == 0)
            values[owners[better]] = total[parts[better]]
        return values

    return sweep


def seconds_of(model: Model) -> float:
    """Return how long a sweep takes, roughly: some operations for each rank, and some for each outcome."""
    ranks = int(np.diff(model.first_outcome).max(initial=0)) + int(np.diff(model.first_pair).max(initial=0))
    return 8e-6 * ranks + 2e-8 * len(model.next_state)


def _pair_values(model: Model, outcomes: list[Rank], later: FloatArray) -> FloatArray:
    total = model.pair_reward.copy()
    for owners, parts in outcomes:
        total[owners] += model.weight[parts] * later[model.next_state[parts]]
    return total


def _of_those_taken(rank: Rank, policy: FloatArray) -> Rank:
    taken = policy[rank.parts] > 0.0
    return Rank(rank.owners[taken], rank.parts[taken])


def _ranks(first: IntArray) -> Iterator[Rank]:
    """Yield the first parts, the second ones, and so on; owner n has those ``first[n]`` .. ``first[n+1]``."""
    counts = np.diff(first)
    for number in range(int(counts.max(initial=0))):
        owners = np.flatnonzero(counts > number)
        yield Rank(owners, first[owners] + number)
