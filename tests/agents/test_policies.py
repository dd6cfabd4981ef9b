"""Policies, interpreted and compiled."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from arms import COINS, NO_VISITS, TESTBED, certain, gaussian, learner, new_rule, pulls
from hypothesis import given, settings
from hypothesis import strategies as st
from random_worlds import worlds
from two_forms import advance

from rl_tui.agents.catalogue import POLICY_BY_ID
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.kernels.compiled import compiled
from rl_tui.agents.kernels.machine_code import machine_code
from rl_tui.agents.learner import Learner
from rl_tui.agents.policies.family import choose, expectation
from rl_tui.common.streams import streams
from rl_tui.worlds.mdp.space import FloatArray, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

pytestmark = pytest.mark.xdist_group("policies")  # each policy's loop is compiled once
SPECIAL = [
    Hyperparameters(policy="softmax", temperature=0.5),
    Hyperparameters(policy="ucb", alpha="sample-average"),
    Hyperparameters(policy="ucb", ties="first", confidence=0.0),
    Hyperparameters(policy="gradient", baseline="none"),
]
EVERY_RULE = [
    (mdp, hyperparameters)
    for mdp in (TESTBED, COINS)
    for hyperparameters in (*(Hyperparameters(policy=policy) for policy in POLICY_BY_ID), *SPECIAL)
]
EVERYDAY = "epsilon-greedy", "ucb"
SOME_RULES_COMPILED = [
    pytest.param(*each, marks=() if each[1].policy in EVERYDAY else pytest.mark.exhaustive("compiles a loop"))
    for each in EVERY_RULE
]


def assert_same(one: Learner, other: Learner) -> None:
    assert one.q.tobytes() == other.q.tobytes()
    assert one.visits.tolist() == other.visits.tolist()
    assert one.last_step == other.last_step
    for mine, yours in zip(one.rule, other.rule, strict=True):
        assert np.asarray(mine).tobytes() == np.asarray(yours).tobytes()
    for mine, yours in zip(one.streams, other.streams, strict=True):
        assert mine.bit_generator.state == yours.bit_generator.state


@pytest.mark.compiled
@pytest.mark.parametrize(("mdp", "hyperparameters"), SOME_RULES_COMPILED)
def test_interpreted_and_compiled_give_the_same_bits(
    mdp: TabularMDP, hyperparameters: Hyperparameters
) -> None:
    ours, interpreted = learner(mdp, hyperparameters, 3), learner(mdp, hyperparameters, 3)
    ours.advance(400)
    advance(interpreted, 400, is_interpreted=True)
    assert_same(ours, interpreted)


@pytest.mark.exhaustive("compiles two loops")
@pytest.mark.compiled
@given(worlds(), st.sampled_from(["softmax", "ucb"]), st.integers(0, 100))
@settings(max_examples=40, deadline=None)
def test_the_same_bits_in_any_world(mdp: TabularMDP, policy: str, seed: int) -> None:
    hyperparameters = Hyperparameters(policy=policy, temperature=0.3)
    ours, interpreted = learner(mdp, hyperparameters, seed), learner(mdp, hyperparameters, seed)
    ours.advance(150)
    advance(interpreted, 150, is_interpreted=True)
    assert_same(ours, interpreted)


@pytest.mark.parametrize(("mdp", "hyperparameters"), EVERY_RULE)
def test_a_checkpoint_brings_back_what_a_rule_has_learned(
    mdp: TabularMDP, hyperparameters: Hyperparameters
) -> None:
    straight, rewound = learner(mdp, hyperparameters), learner(mdp, hyperparameters)
    straight.advance(300)
    rewound.advance(120)
    rewound.drain_episodes()
    kept = rewound.checkpoint()
    rewound.advance(77)
    rewound.configure(Hyperparameters(policy="epsilon-greedy"))
    rewound.advance(10)
    rewound.drain_episodes()
    rewound.restore(kept)
    rewound.advance(180)
    assert_same(straight, rewound)


@pytest.mark.parametrize(
    ("hyperparameters", "changes"),
    [
        (Hyperparameters(policy="gradient"), {"baseline": "none", "alpha": 0.3}),
        (Hyperparameters(policy="thompson"), {"ties": "first"}),
    ],
)
def test_a_change_of_settings_keeps_what_a_rule_has_learned(
    hyperparameters: Hyperparameters, changes: dict[str, Any]
) -> None:
    ours = learner(TESTBED, hyperparameters)
    ours.advance(50)
    learned = [part.tolist() for part in ours.rule if isinstance(part, np.ndarray)]
    ours.configure(replace(hyperparameters, **changes))
    assert [part.tolist() for part in ours.rule if isinstance(part, np.ndarray)] == learned
    ours.advance(1)
    assert [part.tolist() for part in ours.rule if isinstance(part, np.ndarray)] != learned


def test_changed_temperature_and_confidence_are_in_force() -> None:
    ours = learner(TESTBED, Hyperparameters(policy="softmax", temperature=1e6))
    ours.advance(100)
    assert ours.visits.min() > 10
    ours.configure(Hyperparameters(policy="softmax", temperature=1e-9))
    before = ours.visits.copy()
    ours.advance(1)
    assert not ours.last_step.explored
    ours.configure(Hyperparameters(policy="ucb", confidence=1e6))
    ours.advance(1000)
    assert (ours.visits - before).min() > 200


@compiled
def expected(rule: Any, q: FloatArray, visits: IntArray, first: int, last: int) -> float:
    return expectation(rule, q, visits, first, last)


@pytest.mark.parametrize("policy", ["epsilon-greedy", "softmax", "ucb", "gradient"])
def test_compiled_expectations_are_the_same_bits(policy: str) -> None:
    q, visits = np.array([0.3, -2.0, 0.7, 0.1]), np.array([3, 1, 4, 1])
    rule = new_rule(Hyperparameters(policy=policy))
    compiled_form = machine_code(expected)
    assert compiled_form(rule, q, visits, 0, 4) == expected(rule, q, visits, 0, 4)
    assert compiled_form(rule, q, visits, 2, 2) == expected(rule, q, visits, 2, 2) == 0.0


# Softmax


@pytest.mark.parametrize("temperature", [0.1, 1.0, 10.0])
def test_softmax_takes_each_action_as_often_as_the_equation_says(temperature: float) -> None:
    from scipy import stats  # slow to import

    q = np.array([9.0, 0.3, -0.5, 0.1, 0.9])
    rule = new_rule(Hyperparameters(policy="softmax", temperature=temperature))
    generator, counts, draws = np.random.default_rng(1), np.zeros(3), 20_000
    for _ in range(draws):
        pair, explored = choose(rule, q, NO_VISITS, 1, 4, generator)
        assert explored == (pair != 1)
        counts[pair - 1] += 1
    weights = np.exp(q[1:4] / temperature)
    expected = weights / weights.sum()
    assert stats.chisquare(counts, expected * draws).pvalue > 1e-3
    assert expectation(rule, q, NO_VISITS, 1, 4) == pytest.approx(float(expected @ q[1:4]))


@pytest.mark.parametrize("temperature", [5e-324, 1e-300, 1e6])
def test_softmax_stays_finite_at_any_temperature(temperature: float) -> None:
    q = np.array([1e12, -1e12, 1e12, 0.0])
    rule = new_rule(Hyperparameters(policy="softmax", temperature=temperature))
    generator = np.random.default_rng(0)
    taken = {choose(rule, q, NO_VISITS, 0, 4, generator)[0] for _ in range(200)}
    assert taken == {0, 2}
    assert expectation(rule, q, NO_VISITS, 0, 4) == 1e12


# Upper confidence bounds


def plain_ucb(
    means: list[float], confidence: float, ties: str, seed: int, steps: int
) -> list[tuple[int, float]]:
    world, mine = streams(seed)
    sums, counts, taken = [0.0] * len(means), [0] * len(means), []
    estimates = [0.0] * len(means)
    for t in range(1, steps + 1):
        untried = [arm for arm in range(len(means)) if counts[arm] == 0]
        bounds = [
            estimates[arm] + confidence * math.sqrt(math.log(t) / counts[arm]) if counts[arm] else math.inf
            for arm in range(len(means))
        ]
        best = untried or [arm for arm in range(len(means)) if bounds[arm] == max(bounds)]
        arm = best[0]
        if ties == "random" and len(best) > 1:
            arm = best[int(mine.random() * len(best))]
        reward = means[arm] + world.standard_normal()
        counts[arm] += 1
        sums[arm] += reward
        estimates[arm] += 1.0 / counts[arm] * (reward - estimates[arm])
        taken.append((arm, reward))
    return taken


@pytest.mark.parametrize("confidence", [0.0, 1.0, 2.0])
@pytest.mark.parametrize("ties", ["random", "first"])
def test_ucb_goes_step_for_step_with_equation_2_10(confidence: float, ties: Any) -> None:
    means = [0.2, -0.8, 1.5, 0.4, 1.0]
    hyperparameters = Hyperparameters(
        policy="ucb", confidence=confidence, alpha="sample-average", gamma=0.0, ties=ties
    )
    for seed in range(5):
        assert pulls(learner(gaussian(means), hyperparameters, seed), 200) == plain_ucb(
            means, confidence, ties, seed, 200
        )


@given(worlds(), st.integers(0, 100))
@settings(max_examples=20, deadline=None)
def test_ucb_takes_a_greatest_bound_of_its_state(mdp: TabularMDP, seed: int) -> None:
    ours = learner(mdp, Hyperparameters(policy="ucb", confidence=1.5), seed)
    for _ in range(60):
        here, q, visits = mdp.pairs_of(ours.state), ours.q.copy(), ours.visits.copy()
        ours.advance(1)
        last = ours.last_step
        assert last is not None
        if any(visits[pair] == 0 for pair in here):
            assert visits[last.pair] == 0
        else:
            time = visits[here.start : here.stop].sum() + 1
            bounds = [q[pair] + 1.5 * np.sqrt(np.log(time) / visits[pair]) for pair in here]
            assert bounds[last.pair - here.start] == pytest.approx(max(bounds))
        assert last.explored == (q[last.pair] < q[here.start : here.stop].max())


def test_the_expectation_of_ucb_is_the_mean_over_its_ties() -> None:
    q, visits = np.array([1.0, 5.0, 3.0]), np.array([0, 9, 0])
    at_random, first = (new_rule(Hyperparameters(policy="ucb", ties=ties)) for ties in ("random", "first"))
    assert expectation(at_random, q, visits, 0, 3) == 2.0
    assert expectation(first, q, visits, 0, 3) == 1.0
    assert expectation(first, q, np.array([9, 9, 9]), 0, 3) == 5.0
    assert expectation(at_random, q, visits, 1, 1) == 0.0


def test_upper_bounds_know_what_was_tried_by_hand() -> None:
    ours = learner(certain(0.0, 1.0, 0.0), Hyperparameters(policy="ucb", ties="first"))
    ours.take(0)
    ours.take(1)
    ours.advance(1)
    assert ours.last_step.pair == 2  # the only untried one
