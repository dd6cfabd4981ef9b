"""Thompson sampling for bandits (posterior sampling; Sutton & Barto, 2nd ed., section 2.10).

Arms that pay 0 or 1 have a prior Beta(1, 1) on their probability. All others are treated as Gaussian, with a
prior N(0, 1) on the mean and the noise of the transition table. Means are assumed constant.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.random import Generator

from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.kernels.compiled import compiled, inlined, member_of
from rl_tui.agents.kernels.draws import uniform
from rl_tui.agents.policies.family import best_value, choose, probability_of, reinforce
from rl_tui.worlds.mdp.space import FiniteSpace, FloatArray, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP


class Rule(NamedTuple):
    """Number of `rewards`, their `total`, and `variance` of each arm, [P].

    `bernoulli` is set if all arms pay 0 or 1. Without `random_ties` the first of equal draws is taken.
    """

    rewards: IntArray
    total: FloatArray
    variance: FloatArray
    bernoulli: bool
    random_ties: bool


def new_rule(space: FiniteSpace, hyperparameters: Hyperparameters) -> Rule:
    """Return the rule before the first pull."""
    return Rule(
        np.zeros(space.pairs, np.int64),
        np.zeros(space.pairs),
        _variances(space) if isinstance(space, TabularMDP) else np.zeros(space.pairs),
        isinstance(space, TabularMDP) and _pays_0_or_1(space),
        hyperparameters.ties == "random",
    )


def carry_rule(now: Rule, before: Rule, pairs: IntArray) -> None:
    """Copy what is known of common arms. `pairs` holds former numbers, or NEW.

    If arms start paying 0 or 1, earlier rewards are forgotten: they say nothing about a probability.
    """
    if now.bernoulli and not before.bernoulli:
        return
    known = pairs >= 0
    now.rewards[known] = before.rewards[pairs[known]]
    now.total[known] = before.total[pairs[known]]


def _pays_0_or_1(mdp: TabularMDP) -> bool:
    certain = mdp.drift_std == 0.0 and not mdp.reward_std.any()
    return certain and bool(np.isin(mdp.reward, (0.0, 1.0)).all())


def _variances(mdp: TabularMDP) -> FloatArray:
    spread = mdp.reward_std**2 + (mdp.reward - mdp.expected_reward[mdp.outcome_pair]) ** 2
    variance: FloatArray = np.add.reduceat(mdp.probability * spread, mdp.first_outcome[:-1])
    return variance


@compiled
def gamma_draw(shape: float, generator: Generator) -> float:
    """Draw from the gamma distribution with scale 1 and `shape` of at least 1.

    Method of G. Marsaglia and W. W. Tsang, "A simple method for generating gamma variables", ACM TOMS 26
    (2000). The generator's own method has different bits interpreted and compiled.
    """
    d = shape - 1.0 / 3.0
    c = 1.0 / math.sqrt(9.0 * d)
    while True:
        x = generator.standard_normal()
        root = 1.0 + c * x
        if root > 0.0:
            v = root * root * root
            u = 1.0 - uniform(generator)
            # the bound nearly always suffices, which saves the logarithms
            if u < 1.0 - 0.0331 * x * x * x * x or math.log(u) < 0.5 * x * x + d * (1.0 - v + math.log(v)):
                return d * v


@inlined
def beta_draw(successes: float, failures: float, generator: Generator) -> float:
    """Draw a success probability from its posterior Beta(1 + successes, 1 + failures)."""
    for_it = gamma_draw(1.0 + successes, generator)
    against_it = gamma_draw(1.0 + failures, generator)
    return for_it / (for_it + against_it)


@inlined
def normal_draw(count: int, total: float, variance: float, generator: Generator) -> float:
    """Draw a mean from its posterior, given `count` rewards.

    Prior N(0, 1), posterior N(total / (σ² + n), σ² / (σ² + n)). Without noise the first reward decides.
    """
    if count == 0:
        return generator.standard_normal()
    spread = math.sqrt(variance / (variance + count))
    return total / (variance + count) + spread * generator.standard_normal()


@member_of(choose, Rule)
def _choose(
    rule: Rule, q: FloatArray, visits: IntArray, first: int, last: int, generator: Generator
) -> tuple[int, bool]:
    chosen = first
    ties = 0
    highest = -math.inf
    for arm in range(first, last):
        count, total = rule.rewards[arm], float(rule.total[arm])
        if rule.bernoulli:
            draw = beta_draw(total, count - total, generator)
        else:
            draw = normal_draw(count, total, float(rule.variance[arm]), generator)
        if draw > highest:
            chosen = arm
            highest = draw
            ties = 1
        elif draw == highest:
            ties += 1
            if rule.random_ties and uniform(generator) * ties < 1.0:
                chosen = arm
    return chosen, q[chosen] < best_value(q, first, last)


@member_of(probability_of, Rule)
def _probability_of(rule: Rule, q: FloatArray, visits: IntArray, first: int, last: int, pair: int) -> float:
    # The probability of the best draw has no closed form. Bandit steps do not bootstrap, so this is never
    # called; a number here would look exact without being exact
    return math.nan


@member_of(reinforce, Rule)
def _reinforce(rule: Rule, alpha: float, first: int, last: int, pair: int, reward: float) -> None:
    rule.rewards[pair] += 1
    rule.total[pair] += reward
