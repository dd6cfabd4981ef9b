"""Softmax, upper confidence bounds, the gradient bandit and Thompson sampling, each held against its book."""

from __future__ import annotations

import importlib
import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from random_worlds import worlds
from scipy import stats

from rl_tui.agents import loop
from rl_tui.agents.action_rules import gradient, thompson
from rl_tui.agents.action_rules.family import choose, expectation
from rl_tui.agents.action_rules.thompson import beta_draw, gamma_draw, normal_draw
from rl_tui.agents.catalogue import RULE_BY_ID
from rl_tui.agents.compiled import compiled
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.learner import Learner
from rl_tui.worlds.errors import UserError
from rl_tui.worlds.mdp import FloatArray, IntArray, Outcome, TabularMDP, Transition, tabular_mdp
from rl_tui.worlds.streams import streams

NO_VISITS = np.zeros(4, np.int64)


def gaussian(means: list[float], std: float = 1.0) -> TabularMDP:
    return _bandit([[Outcome(1.0, 0, mean, True, std)] for mean in means])


def bernoulli(means: list[float]) -> TabularMDP:
    return _bandit([[Outcome(p, 0, 1.0, True), Outcome(1.0 - p, 0, 0.0, True)] for p in means])


def certain(*rewards: float) -> TabularMDP:
    return _bandit([[Outcome(1.0, 0, reward, True)] for reward in rewards])


def _bandit(arms: list[list[Outcome]]) -> TabularMDP:
    transitions = [Transition(0, arm, outcomes) for arm, outcomes in enumerate(arms)]
    return tabular_mdp(["here"], [str(arm) for arm in range(len(arms))], transitions, {0: 1.0})


TESTBED = gaussian([0.2, -0.8, 1.5, 0.4])
COINS = bernoulli([0.2, 0.9, 0.5, 1.0])
EVERY_RULE = [
    (mdp, told)
    for mdp in (TESTBED, COINS)
    for told in (
        Hyperparameters(policy="softmax", temperature=0.5),
        Hyperparameters(policy="ucb", alpha="sample-average"),
        Hyperparameters(policy="ucb", ties="first", confidence=0.0),
        Hyperparameters(policy="gradient"),
        Hyperparameters(policy="gradient", baseline="none"),
        Hyperparameters(policy="thompson"),
    )
]


def new_rule(told: Hyperparameters, mdp: TabularMDP = TESTBED) -> Any:
    return importlib.import_module(RULE_BY_ID[told.policy].module).new_rule(mdp, told)


def learner(mdp: TabularMDP, told: Hyperparameters, seed: int = 0) -> Learner:
    return Learner(mdp, "q-learning", told, streams(seed))


def pulls(ours: Learner, steps: int) -> list[tuple[int, float]]:
    """Take so many steps one by one and tell which arm each pulled and what it paid."""
    taken = []
    for _ in range(steps):
        ours.advance(1)
        assert ours.last_step is not None
        taken.append((ours.last_step.pair, ours.last_step.reward))
    return taken


def assert_same(one: Learner, other: Learner) -> None:
    assert one.q.tobytes() == other.q.tobytes()
    assert one.visits.tolist() == other.visits.tolist()
    assert one.last_step == other.last_step
    for mine, yours in zip(one._rule, other._rule, strict=True):
        assert np.asarray(mine).tobytes() == np.asarray(yours).tobytes()
    for mine, yours in zip(one.streams, other.streams, strict=True):
        assert mine.bit_generator.state == yours.bit_generator.state


@pytest.mark.parametrize(("mdp", "told"), EVERY_RULE)
def test_interpreted_and_compiled_give_the_same_bits(
    mdp: TabularMDP, told: Hyperparameters, monkeypatch: pytest.MonkeyPatch
) -> None:
    ours, interpreted = learner(mdp, told, 3), learner(mdp, told, 3)
    ours.advance(400)
    monkeypatch.setattr("rl_tui.agents.learner.advance", loop.advance.py_func)
    interpreted.advance(400)
    assert_same(ours, interpreted)


@given(worlds(), st.sampled_from(["softmax", "ucb"]), st.integers(0, 100))
@settings(max_examples=40, deadline=None)
def test_the_same_bits_in_any_world(mdp: TabularMDP, policy: str, seed: int) -> None:
    told = Hyperparameters(policy=policy, temperature=0.3)
    ours, interpreted = learner(mdp, told, seed), learner(mdp, told, seed)
    ours.advance(150)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("rl_tui.agents.learner.advance", loop.advance.py_func)
        interpreted.advance(150)
    assert_same(ours, interpreted)


@pytest.mark.parametrize(("mdp", "told"), EVERY_RULE)
def test_a_checkpoint_brings_back_what_a_rule_has_learned(mdp: TabularMDP, told: Hyperparameters) -> None:
    straight, rewound = learner(mdp, told), learner(mdp, told)
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
    ("told", "changes"),
    [
        (Hyperparameters(policy="gradient"), {"baseline": "none", "alpha": 0.3}),
        (Hyperparameters(policy="thompson"), {"ties": "first"}),
    ],
)
def test_a_change_of_settings_keeps_what_a_rule_has_learned(
    told: Hyperparameters, changes: dict[str, Any]
) -> None:
    ours = learner(TESTBED, told)
    ours.advance(50)
    learned = [part.tolist() for part in ours._rule if isinstance(part, np.ndarray)]
    ours.configure(replace(told, **changes))
    assert [part.tolist() for part in ours._rule if isinstance(part, np.ndarray)] == learned
    ours.advance(1)
    assert [part.tolist() for part in ours._rule if isinstance(part, np.ndarray)] != learned


def test_changed_temperature_and_confidence_are_in_force() -> None:
    ours = learner(TESTBED, Hyperparameters(policy="softmax", temperature=1e6))
    ours.advance(100)
    assert ours.visits.min() > 10
    ours.configure(Hyperparameters(policy="softmax", temperature=1e-9))
    before = ours.visits.copy()
    ours.advance(1)
    assert ours.last_step is not None
    assert not ours.last_step.explored
    ours.configure(Hyperparameters(policy="ucb", confidence=1e6))
    ours.advance(1000)
    assert (ours.visits - before).min() > 200


# Softmax


@pytest.mark.parametrize("temperature", [0.1, 1.0, 10.0])
def test_softmax_takes_each_action_as_often_as_the_equation_says(temperature: float) -> None:
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


def test_softmax_of_equals_is_a_fair_draw() -> None:
    ours = learner(gaussian([0.0] * 4, std=0.0), Hyperparameters(policy="softmax", temperature=1e-9))
    ours.advance(8000)
    assert stats.chisquare(ours.visits).pvalue > 1e-3


# Upper confidence bounds


def plain_ucb(
    means: list[float], confidence: float, ties: str, seed: int, steps: int
) -> list[tuple[int, float]]:
    """Equation 2.10 with sample averages: what each of ``steps`` pulls took and was paid."""
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
    told = Hyperparameters(policy="ucb", confidence=confidence, alpha="sample-average", gamma=0.0, ties=ties)
    for seed in range(5):
        assert pulls(learner(gaussian(means), told, seed), 200) == plain_ucb(
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


# The gradient bandit


def plain_gradient(
    means: list[float], alpha: float, baseline: bool, seed: int, steps: int
) -> tuple[list[tuple[int, float]], list[float]]:
    """Equation 2.12 as it stands: what each of ``steps`` pulls took and was paid, and H in the end."""
    world, mine = streams(seed)
    preferences, rewards, taken = [0.0] * len(means), [], []
    for _ in range(steps):
        weights = [math.exp(each) for each in preferences]
        probabilities = [each / sum(weights) for each in weights]
        point, arm = mine.random(), 0
        while point >= sum(probabilities[: arm + 1]):
            arm += 1
        reward = means[arm] + world.standard_normal()
        against = 0.0
        if baseline:
            against = sum(rewards) / len(rewards) if rewards else reward
        for other in range(len(means)):
            if other == arm:
                preferences[other] += alpha * (reward - against) * (1.0 - probabilities[other])
            else:
                preferences[other] -= alpha * (reward - against) * probabilities[other]
        rewards.append(reward)
        taken.append((arm, reward))
    return taken, preferences


@pytest.mark.parametrize("baseline", [True, False])
def test_the_gradient_bandit_goes_step_for_step_with_equation_2_12(baseline: bool) -> None:
    means = [4.2, 3.2, 5.5, 4.4]
    told = Hyperparameters(policy="gradient", alpha=0.1, baseline="mean" if baseline else "none")
    for seed in range(5):
        ours = learner(gaussian(means), told, seed)
        taken, preferences = plain_gradient(means, 0.1, baseline, seed, 200)
        assert pulls(ours, 200) == taken
        assert ours._rule.preference.tolist() == pytest.approx(preferences, rel=1e-9, abs=1e-12)
        assert ours._rule.probability.sum() == pytest.approx(1.0)


def test_the_gradient_bandit_learns_with_the_step_size_of_the_episode() -> None:
    told = Hyperparameters(
        policy="gradient", alpha=0.5, step_size_schedule="linear", alpha_decay=0.5, baseline="none"
    )
    ours = learner(gaussian([1.0, 1.0], std=0.0), told)
    ours.advance(1)
    learned = ours._rule.preference.tolist()
    assert sorted(learned) == [-0.25, 0.25]
    ours.advance(20)
    assert ours._rule.preference.tolist() == learned


def test_the_expectation_of_the_gradient_bandit_is_that_of_its_probabilities() -> None:
    ours = learner(TESTBED, Hyperparameters(policy="gradient"))
    ours.advance(50)
    wanted = float(ours._rule.probability @ ours.q)
    assert expectation(ours._rule, ours.q, ours.visits, 0, 4) == pytest.approx(wanted)


# Thompson sampling


@pytest.mark.parametrize(("successes", "failures"), [(0, 0), (3, 1), (0, 40), (500, 20)])
def test_draws_of_a_probability_follow_the_beta_distribution(successes: int, failures: int) -> None:
    generator = np.random.default_rng(7)
    drawn = [beta_draw(float(successes), float(failures), generator) for _ in range(4000)]
    assert stats.kstest(drawn, stats.beta(1 + successes, 1 + failures).cdf).pvalue > 1e-3


@pytest.mark.parametrize(("count", "total", "variance"), [(0, 0.0, 1.0), (4, 8.0, 1.0), (9, -3.0, 4.0)])
def test_draws_of_a_mean_follow_the_normal_posterior(count: int, total: float, variance: float) -> None:
    # Conjugate prior: precisions add up, and the mean is weighted by them
    precision = 1.0 + count / variance
    posterior = stats.norm(total / variance / precision, 1.0 / math.sqrt(precision))
    generator = np.random.default_rng(8)
    drawn = [normal_draw(count, total, variance, generator) for _ in range(4000)]
    assert stats.kstest(drawn, posterior.cdf).pvalue > 1e-3


def test_gamma_draws_are_the_same_bits_interpreted() -> None:
    one, other = np.random.default_rng(9), np.random.default_rng(9)
    shapes = [1.0, 1.5, 2.0, 30.0, 1e6] * 200
    assert [gamma_draw(each, one) for each in shapes] == [gamma_draw.py_func(each, other) for each in shapes]


def test_thompson_sampling_counts_what_its_arms_paid() -> None:
    ours = learner(COINS, Hyperparameters(policy="thompson"))
    paid = pulls(ours, 200)
    assert ours._rule.bernoulli
    assert ours._rule.rewards.tolist() == [sum(arm == each for each, _ in paid) for arm in range(4)]
    assert ours._rule.total.tolist() == [
        sum(reward for each, reward in paid if each == arm) for arm in range(4)
    ]


@pytest.mark.parametrize(
    ("mdp", "is_bernoulli", "variance"),
    [
        (COINS, True, [0.16, 0.09, 0.25, 0.0]),
        (TESTBED, False, [1.0] * 4),
        (gaussian([0.5, 2.0], std=0.0), False, [0.0] * 2),
        (replace(gaussian([0.0, 0.0], std=0.0), drift_std=0.1), False, [0.0] * 2),
        (_bandit([[Outcome(0.5, 0, 2.0, True, 1.0), Outcome(0.5, 0, 0.0, True)]]), False, [1.5]),
    ],
)
def test_thompson_sampling_reads_from_the_table_how_arms_pay(
    mdp: TabularMDP, is_bernoulli: bool, variance: list[float]
) -> None:
    rule = new_rule(Hyperparameters(policy="thompson"), mdp)
    assert rule.bernoulli == is_bernoulli
    assert rule.variance.tolist() == pytest.approx(variance)


@pytest.mark.parametrize(("ties", "pulled"), [("first", [True, False]), ("random", [True, True])])
def test_without_noise_one_pull_settles_an_arm(ties: Any, pulled: list[bool]) -> None:
    # Both arms pay the same: once each is known, every draw is a tie
    ours = learner(gaussian([4.0, 4.0], std=0.0), Hyperparameters(policy="thompson", ties=ties))
    ours._rule.rewards[:] = 1
    ours._rule.total[:] = 4.0
    ours.advance(100)
    assert [count > 0 for count in ours.visits.tolist()] == pulled
    if ties == "random":
        assert stats.binomtest(int(ours.visits[0]), 100).pvalue > 1e-3


def test_nobody_is_given_an_expectation_that_has_no_closed_form() -> None:
    rule = new_rule(Hyperparameters(policy="thompson"))
    assert math.isnan(expectation(rule, np.zeros(4), NO_VISITS, 0, 4))


# All of them


@compiled
def expected(rule: Any, q: FloatArray, visits: IntArray, first: int, last: int) -> float:
    return expectation(rule, q, visits, first, last)


@pytest.mark.parametrize("policy", ["epsilon-greedy", "softmax", "ucb", "gradient"])
def test_compiled_expectations_are_the_same_bits(policy: str) -> None:
    q, visits = np.array([0.3, -2.0, 0.7, 0.1]), np.array([3, 1, 4, 1])
    rule = new_rule(Hyperparameters(policy=policy))
    assert expected(rule, q, visits, 0, 4) == expected.py_func(rule, q, visits, 0, 4)
    assert expected(rule, q, visits, 2, 2) == 0.0


def two_states() -> TabularMDP:
    return tabular_mdp(
        ["here", "there"],
        ["go"],
        [Transition(0, 0, [Outcome(1.0, 1, 0.0, False)]), Transition(1, 0, [Outcome(1.0, 1, 0.0, True)])],
        {0: 1.0},
    )


@pytest.mark.parametrize(
    ("mdp", "told", "message"),
    [
        (
            two_states(),
            {"policy": "gradient"},
            "policy gradient is for bandits: take epsilon-greedy, softmax",
        ),
        (
            two_states(),
            {"policy": "thompson"},
            "policy thompson is for bandits: take epsilon-greedy, softmax",
        ),
        (TESTBED, {"policy": "gradient", "alpha": "sample-average"}, "give a number for alpha, such as 0.1"),
        (TESTBED, {"policy": "gradient", "step_size_schedule": "sample-average"}, "give a number for alpha"),
    ],
)
def test_what_cannot_work_is_refused_in_one_line(mdp: TabularMDP, told: dict[str, Any], message: str) -> None:
    def refused(act: Callable[[], object]) -> None:
        with pytest.raises(UserError, match=message) as error:
            act()
        assert len(str(error.value).splitlines()) == 1

    unfit = Hyperparameters(**told)
    refused(lambda: learner(mdp, unfit))
    ours = learner(mdp, Hyperparameters())
    refused(lambda: ours.configure(unfit))
    ours.advance(5)


def test_the_gradient_bandit_prefers_what_paid_by_hand() -> None:
    ours = learner(certain(0.0, 1.0), Hyperparameters(alpha=0.5, policy="gradient"))
    ours.take(0)
    ours.take(1)
    assert isinstance(ours._rule, gradient.Rule)
    # R̄ = 0, the reward is 1: ± α (R − R̄) / 2
    assert ours._rule.preference.tolist() == [-0.25, 0.25]


def test_thompson_sampling_counts_what_was_pulled_by_hand() -> None:
    ours = learner(certain(0.0, 1.0), Hyperparameters(policy="thompson"))
    for arm in (1, 1, 0):
        ours.take(arm)
    assert isinstance(ours._rule, thompson.Rule)
    assert (ours._rule.rewards.tolist(), ours._rule.total.tolist()) == ([1, 2], [0.0, 2.0])


def test_upper_bounds_know_what_was_tried_by_hand() -> None:
    ours = learner(certain(0.0, 1.0, 0.0), Hyperparameters(policy="ucb", ties="first"))
    ours.take(0)
    ours.take(1)
    ours.advance(1)
    assert ours.last_step is not None
    assert ours.last_step.pair == 2  # the only one that was never tried
