from __future__ import annotations

import importlib
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from arms import COINS
from curious_policy import CURIOUS
from hypothesis import given
from hypothesis import strategies as st
from plain_world import PlainWorld

from rl_tui.agents.catalogue import POLICY_BY_ID, Policy
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.kernels.compiled import compiled
from rl_tui.agents.kernels.machine_code import machine_code
from rl_tui.agents.learner import Learner
from rl_tui.agents.policies.chances import action_chances
from rl_tui.agents.policies.family import choose, expectation, in_force, learns, probability_of
from rl_tui.common.streams import streams
from rl_tui.worlds.mdp.space import FloatArray, IntArray, all_pairs

NO_VISITS = np.zeros(4, np.int64)
Q = np.array([1.0, 3.0, 3.0, 0.0])


def chances(
    hyperparameters: Hyperparameters, epsilon: float = 0.0, visits: Any = NO_VISITS
) -> list[float] | None:
    found = action_chances(hyperparameters, epsilon, Q, visits)
    return None if found is None else found.tolist()


def test_epsilon_is_shared_by_all_and_the_rest_by_the_best() -> None:
    assert chances(Hyperparameters(), 0.2) == pytest.approx([0.05, 0.45, 0.45, 0.05])
    assert chances(Hyperparameters(ties="first"), 0.2) == pytest.approx([0.05, 0.85, 0.05, 0.05])


def test_softmax_weighs_by_powers() -> None:
    weights = np.exp([1.0, 3.0, 3.0, 0.0])
    assert chances(Hyperparameters(policy="softmax", temperature=1.0)) == pytest.approx(
        (weights / weights.sum()).tolist()
    )


def test_ucb_takes_what_was_never_tried_first() -> None:
    hyperparameters = Hyperparameters(policy="ucb")
    assert chances(hyperparameters, visits=np.array([5, 5, 0, 0])) == [0.0, 0.0, 0.5, 0.5]
    # t = 23: 1 + 2 √(ln 23 / 1) = 4.54 is more than 3 + 2 √(ln 23 / 10) = 4.12
    assert chances(hyperparameters, visits=np.array([1, 10, 10, 1])) == [1.0, 0.0, 0.0, 0.0]


def rule_of(hyperparameters: Hyperparameters, actions: int) -> Any:
    space = all_pairs(["s"], [str(action) for action in range(actions)], 0)
    return importlib.import_module(POLICY_BY_ID[hyperparameters.policy].module).new_rule(
        space, hyperparameters
    )


@pytest.mark.parametrize("policy", [row.id for row in POLICY_BY_ID.values() if row.bandits_only])
def test_what_a_policy_has_learned_is_not_known(policy: str) -> None:
    assert learns(rule_of(Hyperparameters(policy=policy), 4))
    assert chances(Hyperparameters(policy=policy)) is None


@pytest.mark.parametrize("policy", POLICY_BY_ID)
def test_nothing_is_told_where_an_estimate_is_not_a_number(policy: str) -> None:
    q, visits = np.array([1.0, math.nan]), np.array([3, 4])
    assert action_chances(Hyperparameters(policy=policy), 0.1, q, visits) is None


@given(
    q=st.lists(st.sampled_from([0.0, 0.1, 0.3, 1.0]) | st.floats(-5, 5), min_size=1, max_size=5),
    counts=st.lists(st.integers(0, 9), min_size=5, max_size=5),
    policy=st.sampled_from([*POLICY_BY_ID, CURIOUS.id]),
    ties=st.sampled_from(["random", "first"]),
)
def test_every_policy_expects_what_its_probabilities_say(
    q: list[float], counts: list[int], policy: str, ties: Any
) -> None:
    hyperparameters = Hyperparameters(policy=policy, ties=ties, epsilon=0.3, temperature=0.7)
    estimates, visits = np.array(q), np.array(counts[: len(q)], dtype=np.int64)
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(POLICY_BY_ID, CURIOUS.id, CURIOUS)
        rule = rule_of(hyperparameters, len(q))
        told = action_chances(hyperparameters, 0.3, estimates, visits)
    weights = [probability_of(rule, estimates, visits, 0, len(q), pair) for pair in range(len(q))]
    if policy == "thompson":
        assert np.isnan(weights).all()  # no closed form, and no estimate instead
        return
    assert sum(weights) == pytest.approx(1.0)
    assert min(weights) >= 0.0
    assert weights @ estimates == pytest.approx(expectation(rule, estimates, visits, 0, len(q)), abs=1e-12)
    assert told is None if learns(rule) else told.tolist() == weights


@given(
    q=st.lists(st.sampled_from([0.0, 0.1, 0.3, 1.0]) | st.floats(-5, 5), min_size=4, max_size=4),
    epsilon=st.sampled_from([0.0, 0.1, 0.3, 1.0]),
    ties=st.sampled_from(["random", "first"]),
)
def test_plain_boxes_have_the_same_probabilities(q: list[float], epsilon: float, ties: Any) -> None:
    hyperparameters = Hyperparameters(epsilon=epsilon, ties=ties)
    pairs = range(COINS.pairs)
    plain = PlainWorld(COINS, hyperparameters, streams(0), steps=1)
    state, table = plain.start(), dict(enumerate(q))
    estimates, visits = np.array(q), np.zeros(COINS.pairs, np.int64)
    rule = rule_of(hyperparameters, COINS.pairs)
    ours = [probability_of(rule, estimates, visits, 0, COINS.pairs, pair) for pair in pairs]
    theirs = [plain.probability(state, pair, table) for pair in pairs]
    assert theirs == ours  # to the bit
    expected = sum(chance * table[pair] for pair, chance in zip(pairs, theirs, strict=True))
    assert plain.expectation(state, table) == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("policy", [*POLICY_BY_ID, CURIOUS.id])
def test_every_policy_draws_by_its_probabilities(policy: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(POLICY_BY_ID, CURIOUS.id, CURIOUS)
    rule = rule_of(Hyperparameters(policy=policy, epsilon=0.4), 4)
    generator, draws = np.random.default_rng(3), 4_000
    for visits in (np.array([3, 0, 2, 0]), np.array([3, 1, 2, 4])):
        weights = [probability_of(rule, Q, visits, 0, 4, pair) for pair in range(4)]
        taken = np.bincount([choose(rule, Q, visits, 0, 4, generator)[0] for _ in range(draws)], minlength=4)
        if policy != "thompson":
            assert taken / draws == pytest.approx(np.array(weights), abs=0.03)


@pytest.mark.parametrize("row", POLICY_BY_ID.values(), ids=lambda row: row.id)
def test_a_policy_that_names_a_schedule_follows_it(row: Policy) -> None:
    rule = rule_of(Hyperparameters(policy=row.id), 4)
    assert (in_force(rule, 0.037) is not rule) == ("epsilon_decay" in row.parameters)


@compiled
def probabilities(rule: Any, q: FloatArray, visits: IntArray, weights: FloatArray) -> None:
    for pair in range(len(weights)):
        weights[pair] = probability_of(rule, q, visits, 0, len(weights), pair)


@pytest.mark.parametrize("policy", POLICY_BY_ID)
def test_compiled_probabilities_are_the_same_bits(policy: str) -> None:
    rule = rule_of(Hyperparameters(policy=policy, temperature=0.7), 4)
    both = np.zeros(4), np.zeros(4)
    machine_code(probabilities)(rule, Q, np.array([3, 1, 4, 1]), both[0])
    probabilities(rule, Q, np.array([3, 1, 4, 1]), both[1])
    assert both[0].tobytes() == both[1].tobytes()


def test_a_new_policy_is_its_module_and_its_row(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(POLICY_BY_ID, CURIOUS.id, CURIOUS)
    monkeypatch.setattr(Learner, "is_compiled", False)
    ours = Learner(COINS, "expected-sarsa", Hyperparameters(policy=CURIOUS.id, epsilon=1.0), streams(0))
    ours.advance(4)
    assert ours.visits.tolist() == [1, 1, 1, 1]
    assert ours.last_step.epsilon == 1.0
    ours.configure(replace(ours.hyperparameters, epsilon=0.5))
    ours.advance(1)
    assert ours.last_step.epsilon == 0.5
