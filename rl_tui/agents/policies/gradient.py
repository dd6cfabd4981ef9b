"""The gradient bandit: preferences, not values (Sutton & Barto, 2nd ed., section 2.8, equation 2.12)."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.random import Generator

from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.kernels.compiled import inlined, member_of
from rl_tui.agents.kernels.draws import uniform
from rl_tui.agents.policies.family import best_value, choose, probability_of, reinforce
from rl_tui.worlds.mdp.space import FiniteSpace, FloatArray, IntArray


class Rule(NamedTuple):
    """The preferences H, `preference`, and their softmax π, `probability`, both [P].

    The baseline R̄ is `mean_reward`, the average of the `rewards` received so far, [1] each, or 0 without
    `with_baseline`.
    """

    preference: FloatArray
    probability: FloatArray
    mean_reward: FloatArray
    rewards: IntArray
    with_baseline: bool


def new_rule(space: FiniteSpace, hyperparameters: Hyperparameters) -> Rule:
    """Return the rule before the first pull, with preferences of 0."""
    return Rule(
        np.zeros(space.pairs),
        np.full(space.pairs, 1.0 / space.pairs),
        np.zeros(1),
        np.zeros(1, np.int64),
        hyperparameters.baseline == "mean",
    )


def carry_rule(now: Rule, before: Rule, pairs: IntArray) -> None:
    """Copy the preferences of common arms. New arms get 0. `pairs` holds former numbers, or NEW."""
    known = pairs >= 0
    now.preference[known] = before.preference[pairs[known]]
    now.mean_reward[:] = before.mean_reward
    now.rewards[:] = before.rewards
    _take_softmax(now, 0, len(now.preference))


@inlined
def _take_softmax(rule: Rule, first: int, last: int) -> None:
    # π(a) ← exp H(a) / Σ exp H(b) for the arms `first` .. `last` − 1
    highest = best_value(rule.preference, first, last)
    total = 0.0
    for arm in range(first, last):
        rule.probability[arm] = math.exp(rule.preference[arm] - highest)
        total += rule.probability[arm]
    for arm in range(first, last):
        rule.probability[arm] /= total


@member_of(choose, Rule)
def _choose(
    rule: Rule, q: FloatArray, visits: IntArray, first: int, last: int, generator: Generator
) -> tuple[int, bool]:
    draw = uniform(generator)
    chosen = first
    below = float(rule.probability[first])
    while draw >= below and chosen < last - 1:
        chosen += 1
        below += rule.probability[chosen]
    return chosen, q[chosen] < best_value(q, first, last)


@member_of(probability_of, Rule)
def _probability_of(rule: Rule, q: FloatArray, visits: IntArray, first: int, last: int, pair: int) -> float:
    return float(rule.probability[pair])


@member_of(reinforce, Rule)
def _reinforce(rule: Rule, alpha: float, first: int, last: int, pair: int, reward: float) -> None:
    # R̄ is the mean of earlier rewards; for the first reward it is that reward (page 37). So it does not
    # depend on the action, as the derivation on page 39 requires
    if rule.rewards[0] == 0:
        rule.mean_reward[0] = reward
    baseline = rule.mean_reward[0] if rule.with_baseline else 0.0
    # H(A) ← H(A) + α (R − R̄) (1 − π(A)),  H(a) ← H(a) − α (R − R̄) π(a) for all others
    change = alpha * (reward - baseline)
    for arm in range(first, last):
        taken = 1.0 if arm == pair else 0.0
        rule.preference[arm] += change * (taken - rule.probability[arm])
    _take_softmax(rule, first, last)
    rule.rewards[0] += 1
    rule.mean_reward[0] += (reward - rule.mean_reward[0]) / rule.rewards[0]
