"""Upper confidence bounds per state (Sutton & Barto, 2nd ed., section 2.7, equation 2.10)."""

from __future__ import annotations

import math
from typing import NamedTuple

from numpy.random import Generator

from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.kernels.compiled import inlined, member_of
from rl_tui.agents.kernels.draws import uniform
from rl_tui.agents.policies.family import choose, expectation, probability_of
from rl_tui.worlds.mdp.space import FiniteSpace, FloatArray, IntArray


class Rule(NamedTuple):
    """The confidence c. Without `random_ties` the first of equal bounds is taken."""

    confidence: float
    random_ties: bool


def new_rule(space: FiniteSpace, hyperparameters: Hyperparameters) -> Rule:
    """Return the rule for these settings."""
    return Rule(float(hyperparameters.confidence), hyperparameters.ties == "random")


@inlined
def log_time(visits: IntArray, first: int, last: int) -> float:
    """Return ln t of the next step in this state, from t = 1."""
    time = 1
    for pair in range(first, last):
        time += visits[pair]
    return math.log(time)


@inlined
def upper_bound(confidence: float, estimate: float, count: int, log_time: float) -> float:
    """Return Q + c √(ln t / N): infinite for an action never tried, even at c = 0."""
    if count == 0:
        return math.inf
    return estimate + confidence * math.sqrt(log_time / count)


@member_of(choose, Rule)
def _choose(
    rule: Rule, q: FloatArray, visits: IntArray, first: int, last: int, generator: Generator
) -> tuple[int, bool]:
    # A ← argmax [Q(S,a) + c √(ln t / N(S,a))]
    now = log_time(visits, first, last)
    chosen = first
    ties = 0
    highest = -math.inf
    best_estimate = -math.inf
    for pair in range(first, last):
        best_estimate = max(best_estimate, float(q[pair]))
        bound = upper_bound(rule.confidence, float(q[pair]), visits[pair], now)
        if bound > highest:
            chosen = pair
            highest = bound
            ties = 1
        elif bound == highest:
            ties += 1
    if rule.random_ties and ties > 1:
        skip = min(int(uniform(generator) * ties), ties - 1)
        while skip > 0:
            chosen += 1
            skip -= upper_bound(rule.confidence, float(q[chosen]), visits[chosen], now) == highest
    return chosen, q[chosen] < best_estimate


@member_of(probability_of, Rule)
def _probability_of(rule: Rule, q: FloatArray, visits: IntArray, first: int, last: int, pair: int) -> float:
    # 1 for the greatest bound; ties share it, or the first gets all
    now = log_time(visits, first, last)
    own = upper_bound(rule.confidence, float(q[pair]), visits[pair], now)
    share, ties = 1.0, 0
    for each in range(first, last):
        bound = upper_bound(rule.confidence, float(q[each]), visits[each], now)
        if bound > own or (bound == own and each < pair and not rule.random_ties):
            share = 0.0
        ties += bound == own
    return share / ties if rule.random_ties else share


@member_of(expectation, Rule)
def _expectation(rule: Rule, q: FloatArray, visits: IntArray, first: int, last: int) -> float:
    if first == last:
        return 0.0
    now = log_time(visits, first, last)
    ties = 0
    total = 0.0
    highest = -math.inf
    for pair in range(first, last):
        bound = upper_bound(rule.confidence, float(q[pair]), visits[pair], now)
        if bound > highest:
            total = float(q[pair])
            highest = bound
            ties = 1
        elif bound == highest and rule.random_ties:
            total += float(q[pair])
            ties += 1
    return total / ties
