"""Policies as arrays, [P]: the probability of each pair, which sum to 1 in every state that owns any."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

import numpy as np

from rl_tui.agents.hyperparameters import Ties
from rl_tui.worlds.mdp.space import BoolArray, FiniteSpace, FloatArray, IntArray

SUM_TOLERANCE: Final = 1e-9

Choice = int | Mapping[int, float]
"""What is done in a state: one pair, or the probability of each of some pairs."""


def uniform_policy(space: FiniteSpace) -> FloatArray:
    """Return the policy, [P], that picks uniformly among all legal actions."""
    return uniform_over(space, np.ones(space.pairs, dtype=np.bool_))


def uniform_over(space: FiniteSpace, chosen: BoolArray) -> FloatArray:
    """Return the policy that picks uniformly among ``chosen`` pairs, at least one a live state.

    Both are [P], or [B, P] for as many policies.
    """
    first, count = _live_states(space)
    share = 1.0 / np.add.reduceat(chosen, first, axis=-1, dtype=np.float64)
    return np.where(chosen, np.repeat(share, count, axis=-1), 0.0)


def greedy_policy(space: FiniteSpace, q: FloatArray, ties: Ties) -> FloatArray:
    """Return the policy that is greedy for ``q``; both are [P], or [B, P] for as many policies.

    Ties are exact equality, as the agent itself compares: ``random`` picks among them uniformly, ``first``
    takes the first action.
    """
    tied = best_pairs(space, q)
    return uniform_over(space, tied) if ties == "random" else _first_of(space, tied)


def best_pairs(space: FiniteSpace, of_pairs: FloatArray, slack: float = 0.0) -> BoolArray:
    """Return which pairs have the greatest of the numbers ``of_pairs`` of their state: all ties.

    Both are [P], or [B, P] for as many sets of numbers. Those that have less by at most ``slack``, 0 or more,
    count as well.
    """
    first, count = _live_states(space)
    greatest = np.maximum.reduceat(of_pairs, first, axis=-1)
    return np.asarray(of_pairs >= np.repeat(greatest, count, axis=-1) - slack)


def softened(space: FiniteSpace, policy: FloatArray, epsilon: float) -> FloatArray:
    """Return the policy, [P], that takes a uniformly random action ``epsilon`` of the time, else ``policy``.

    ``epsilon`` is in [0, 1]. The random action may be the one that ``policy`` takes (equation 2.2 and the
    ε-soft policies of section 5.4).
    """
    return (1.0 - epsilon) * policy + epsilon * uniform_policy(space)


def policy_of_choices(space: FiniteSpace, choices: Mapping[int, Choice]) -> FloatArray:
    """Return the policy, [P], that does in each state what ``choices`` says: a pair, or the chance of each.

    A state that is not among them picks uniformly among its legal actions. Chances are scaled to sum to
    exactly 1. Raises ValueError where a pair is not one of its state, or chances are below 0 or do not sum
    to 1 (±1e-9).
    """
    policy = uniform_policy(space)
    for state, choice in choices.items():
        chances = choice if isinstance(choice, Mapping) else {choice: 1.0}
        own, total = space.pairs_of(state), sum(chances.values())
        if not all(pair in own for pair in chances):
            raise ValueError(f"state {state}: not all of {list(chances)} are its pairs")
        if not all(chance >= 0.0 for chance in chances.values()) or not abs(total - 1.0) <= SUM_TOLERANCE:
            raise ValueError(f"state {state}: {list(chances.values())} are no probabilities that sum to 1")
        policy[own.start : own.stop] = 0.0
        for pair, chance in chances.items():
            policy[pair] = chance / total
    return policy


def _first_of(space: FiniteSpace, chosen: BoolArray) -> FloatArray:
    first, count = _live_states(space)
    before: IntArray = np.cumsum(chosen, axis=-1) - chosen
    return np.where(chosen & (before == np.repeat(before[..., first], count, axis=-1)), 1.0, 0.0)


def _live_states(space: FiniteSpace) -> tuple[IntArray, IntArray]:
    """Return the first pair of every state that owns any, and how many it owns."""
    count = np.diff(space.first_pair)
    live = count > 0
    return space.first_pair[:-1][live], count[live]
