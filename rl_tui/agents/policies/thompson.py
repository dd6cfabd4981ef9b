"""Thompson sampling for bandits (posterior sampling; Sutton & Barto, 2nd ed., section 2.10).

Arms that pay 0 or 1 start from a uniform prior on their probability, Beta(1, 1). All others are taken for
Gaussian, with a prior N(0, 1) on the mean and the noise that the table gives. Means are taken to stand still.
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
    """What is known of each arm, [P]: how many ``rewards`` it has paid, their ``total``, its ``variance``.

    ``bernoulli`` says that all pay 0 or 1; ``random_ties`` is false where the first of equal draws is taken.
    """

    rewards: IntArray
    total: FloatArray
    variance: FloatArray
    bernoulli: bool
    random_ties: bool


def new_rule(space: FiniteSpace, hyperparameters: Hyperparameters) -> Rule:
    """Return the rule before the first pull; the table says how its arms pay."""
    return Rule(
        np.zeros(space.pairs, np.int64),
        np.zeros(space.pairs),
        _variances(space) if isinstance(space, TabularMDP) else np.zeros(space.pairs),
        isinstance(space, TabularMDP) and _pays_0_or_1(space),
        hyperparameters.ties == "random",
    )


def carry_rule(now: Rule, before: Rule, pairs: IntArray) -> None:
    """Let ``now`` know what ``before`` knew of the arms that stay: for each of ``pairs`` its number before.

    How they pay is what the table says now. Arms that come to pay otherwise than 0 or 1 keep their counts;
    rewards of arms that did tell of no probability of 0 and 1, and are forgotten.
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
    """Return the variance of the reward of each pair, [P]."""
    spread = mdp.reward_std**2 + (mdp.reward - mdp.expected_reward[mdp.outcome_pair]) ** 2
    variance: FloatArray = np.add.reduceat(mdp.probability * spread, mdp.first_outcome[:-1])
    return variance


@compiled
def gamma_draw(shape: float, generator: Generator) -> float:
    """Draw from the gamma distribution of ``shape``, at least 1, and scale 1.

    The method of G. Marsaglia and W. W. Tsang, "A simple method for generating gamma variables", ACM TOMS 26
    (2000). The generator's own is not the same bits when interpreted as when compiled.
    """
    d = shape - 1.0 / 3.0
    c = 1.0 / math.sqrt(9.0 * d)
    while True:
        x = generator.standard_normal()
        root = 1.0 + c * x
        if root > 0.0:
            v = root * root * root
            u = 1.0 - uniform(generator)
            # nearly always the bound suffices, which spares the logarithms
            if u < 1.0 - 0.0331 * x * x * x * x or math.log(u) < 0.5 * x * x + d * (1.0 - v + math.log(v)):
                return d * v


@inlined
def beta_draw(successes: float, failures: float, generator: Generator) -> float:
    """Draw a probability of which so many successes and failures were seen, from Beta(1 + s, 1 + f)."""
    for_it = gamma_draw(1.0 + successes, generator)
    against_it = gamma_draw(1.0 + failures, generator)
    return for_it / (for_it + against_it)


@inlined
def normal_draw(count: int, total: float, variance: float, generator: Generator) -> float:
    """Draw a mean of which ``count`` rewards came to ``total``, their noise having this ``variance``.

    Prior N(0, 1), posterior N(total / (σ² + n), σ² / (σ² + n)): without noise the first reward settles it.
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
    # How likely an arm is to give the best draw has no closed form. No step of a bandit bootstraps, so
    # this is never called; a number here would be an estimate that looks like an exact value.
    return math.nan


@member_of(reinforce, Rule)
def _reinforce(rule: Rule, alpha: float, first: int, last: int, pair: int, reward: float) -> None:
    rule.rewards[pair] += 1
    rule.total[pair] += reward
