"""ε-greedy with explicit ties (Sutton & Barto, 2nd ed., section 2.2 and page 101)."""

from __future__ import annotations

from typing import NamedTuple

from numpy.random import Generator

from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.kernels.compiled import member_of
from rl_tui.agents.kernels.draws import uniform
from rl_tui.agents.policies.family import (
    best_value,
    choose,
    expectation,
    greedy,
    greedy_in_turn,
    in_force,
    probability_of,
)
from rl_tui.worlds.mdp.space import FiniteSpace, FloatArray, IntArray


class Rule(NamedTuple):
    """The current ε. Without `random_ties` the first of equal best actions is taken.

    `in_turn` is set if several runs take turns on one processor. The choice then avoids unpredictable
    branches, with the same result.
    """

    epsilon: float
    random_ties: bool
    in_turn: bool = False


def new_rule(space: FiniteSpace, hyperparameters: Hyperparameters) -> Rule:
    """Return the rule for these settings."""
    return Rule(float(hyperparameters.epsilon), hyperparameters.ties == "random")


@member_of(in_force, Rule)
def _in_force(rule: Rule, epsilon: float) -> Rule:
    return Rule(epsilon, rule.random_ties, rule.in_turn)


@member_of(choose, Rule)
def _choose(
    rule: Rule, q: FloatArray, visits: IntArray, first: int, last: int, generator: Generator
) -> tuple[int, bool]:
    # One draw serves twice: below ε, draw / ε is again uniform on [0, 1), and above it (draw − ε) / (1 − ε)
    # is
    draw = uniform(generator)
    explore = draw < rule.epsilon
    if explore:
        pair = first + int(draw / rule.epsilon * (last - first))
    else:
        rest = (draw - rule.epsilon) / (1.0 - rule.epsilon)
        pair = (
            greedy_in_turn(q, first, last, rule.random_ties, rest)
            if rule.in_turn
            else greedy(q, first, last, rule.random_ties, rest)
        )
    return pair, explore


@member_of(probability_of, Rule)
def _probability_of(rule: Rule, q: FloatArray, visits: IntArray, first: int, last: int, pair: int) -> float:
    # π(a|s) = ε / |A(s)|, plus 1 − ε for the greedy action; ties share that, or the first gets all
    share, ties = 1.0, 0
    for each in range(first, last):
        tied = q[each] == q[pair]
        if q[each] > q[pair] or (tied and each < pair and not rule.random_ties):
            share = 0.0
        ties += tied
    greedy_share = share / ties if rule.random_ties else share
    return (1.0 - rule.epsilon) * greedy_share + rule.epsilon / (last - first)


@member_of(expectation, Rule)
def _expectation(rule: Rule, q: FloatArray, visits: IntArray, first: int, last: int) -> float:
    # (1 − ε) max Q(s,·) + ε mean Q(s,·)
    if first == last:
        return 0.0
    total = 0.0
    for pair in range(first, last):
        total += float(q[pair])
    return (1.0 - rule.epsilon) * best_value(q, first, last) + rule.epsilon * total / (last - first)
