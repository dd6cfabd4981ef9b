"""Policies as arrays: the probability of each pair in its state."""

from __future__ import annotations

import numpy as np

from rl_tui.agents.hyperparameters import Ties
from rl_tui.worlds.mdp.space import BoolArray, FiniteSpace, FloatArray, IntArray


def greedy_policy(space: FiniteSpace, q: FloatArray, ties: Ties) -> FloatArray:
    """Return the policy, [P], that is greedy for ``q``, [P].

    Ties are exact equality, as the agent itself compares: ``random`` picks among them uniformly, ``first``
    takes the first action.
    """
    first, count = _live_states(space)
    tied = q == np.repeat(np.maximum.reduceat(q, first), count)
    return uniform_over(space, tied) if ties == "random" else _first_of(space, tied)


def uniform_over(space: FiniteSpace, chosen: BoolArray) -> FloatArray:
    """Return the policy, [P], that picks uniformly among ``chosen`` pairs, [P], at least one a live state."""
    first, count = _live_states(space)
    share = 1.0 / np.add.reduceat(chosen, first, dtype=np.float64)
    return np.where(chosen, np.repeat(share, count), 0.0)


def _first_of(space: FiniteSpace, chosen: BoolArray) -> FloatArray:
    first, count = _live_states(space)
    before: IntArray = np.cumsum(chosen) - chosen
    return np.where(chosen & (before == np.repeat(before[first], count)), 1.0, 0.0)


def _live_states(space: FiniteSpace) -> tuple[IntArray, IntArray]:
    """Return the first pair of every state that owns any, and how many it owns."""
    count = np.diff(space.first_pair)
    live = count > 0
    return space.first_pair[:-1][live], count[live]
