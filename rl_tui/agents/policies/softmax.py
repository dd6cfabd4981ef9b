"""Softmax of the estimates with a temperature (Sutton & Barto, 2nd ed., exercise 2.9 and section 13.1)."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.random import Generator

from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.kernels.compiled import member_of
from rl_tui.agents.kernels.draws import uniform
from rl_tui.agents.policies.family import best_value, choose, expectation, probability_of
from rl_tui.worlds.mdp.space import FiniteSpace, FloatArray, IntArray


class Rule(NamedTuple):
    """The temperature τ, and scratch memory for running sums over actions, [A]."""

    temperature: float
    sums: FloatArray


def new_rule(space: FiniteSpace, hyperparameters: Hyperparameters) -> Rule:
    """Return the rule for these settings."""
    return Rule(float(hyperparameters.temperature), np.zeros(len(space.action_names)))


@member_of(choose, Rule)
def _choose(
    rule: Rule, q: FloatArray, visits: IntArray, first: int, last: int, generator: Generator
) -> tuple[int, bool]:
    # π(a|s) ∝ exp(Q(s,a) / τ); subtracting the greatest avoids overflow and gives the best one the weight 1
    highest = best_value(q, first, last)
    total = 0.0
    for pair in range(first, last):
        total += math.exp((float(q[pair]) - highest) / rule.temperature)
        rule.sums[pair - first] = total
    point = uniform(generator) * total
    chosen = first
    # The draw is below the last sum. Counting the passed sums avoids branch mispredictions
    for place in range(last - first - 1):
        chosen += point >= rule.sums[place]
    return chosen, q[chosen] < highest


@member_of(probability_of, Rule)
def _probability_of(rule: Rule, q: FloatArray, visits: IntArray, first: int, last: int, pair: int) -> float:
    highest = best_value(q, first, last)
    total = 0.0
    for each in range(first, last):
        total += math.exp((float(q[each]) - highest) / rule.temperature)
    return math.exp((float(q[pair]) - highest) / rule.temperature) / total


@member_of(expectation, Rule)
def _expectation(rule: Rule, q: FloatArray, visits: IntArray, first: int, last: int) -> float:
    if first == last:
        return 0.0
    highest = best_value(q, first, last)
    total = 0.0
    weighted = 0.0
    for pair in range(first, last):
        weight = math.exp((float(q[pair]) - highest) / rule.temperature)
        total += weight
        weighted += weight * float(q[pair])
    return weighted / total
