"""A made-up policy: with probability ε an untried action, if any, otherwise the first of the best."""

from __future__ import annotations

from typing import NamedTuple

import pytest
from numpy.random import Generator

from rl_tui.agents.catalogue import POLICY_BY_ID, Policy
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.kernels.compiled import inlined, member_of
from rl_tui.agents.policies.family import best_value, choose, greedy, probability_of
from rl_tui.worlds.mdp.space import FiniteSpace, FloatArray, IntArray

CURIOUS = Policy(
    id="curious",
    name="curious",
    summary="the best action, but with probability ε one that was never tried",
    equation="A ← argmax Q(S,·), or with probability ε an action with N(S,a) = 0",
    source="made up",
    module="curious_policy",
    parameters=("epsilon",),
)


@pytest.fixture
def curious(monkeypatch: pytest.MonkeyPatch) -> str:
    monkeypatch.setitem(POLICY_BY_ID, CURIOUS.id, CURIOUS)
    return CURIOUS.id


class Rule(NamedTuple):
    epsilon: float


def new_rule(space: FiniteSpace, hyperparameters: Hyperparameters) -> Rule:
    return Rule(hyperparameters.epsilon)


@inlined
def untried(visits: IntArray, first: int, last: int) -> int:
    count = 0
    for pair in range(first, last):
        count += visits[pair] == 0
    return count


@member_of(choose, Rule)
def _choose(
    rule: Rule, q: FloatArray, visits: IntArray, first: int, last: int, generator: Generator
) -> tuple[int, bool]:
    pair = greedy(q, first, last, False, 0.0)
    left = untried(visits, first, last)
    if left > 0 and generator.random() < rule.epsilon:
        skip = int(generator.random() * left)
        pair = first
        while visits[pair] > 0 or skip > 0:
            skip -= visits[pair] == 0
            pair += 1
    return pair, q[pair] < best_value(q, first, last)


@member_of(probability_of, Rule)
def _probability_of(rule: Rule, q: FloatArray, visits: IntArray, first: int, last: int, pair: int) -> float:
    left = untried(visits, first, last)
    curiosity = rule.epsilon if left > 0 else 0.0
    probability = curiosity / left if visits[pair] == 0 else 0.0
    if pair == greedy(q, first, last, False, 0.0):
        probability += 1.0 - curiosity
    return probability
