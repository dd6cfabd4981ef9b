"""The gradient bandit and Thompson sampling."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from arms import COINS, NO_VISITS, TESTBED, bandit_of, certain, gaussian, learner, new_rule, pulls

from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.kernels.machine_code import machine_code
from rl_tui.agents.policies import gradient, thompson
from rl_tui.agents.policies.family import expectation
from rl_tui.agents.policies.thompson import beta_draw, gamma_draw, normal_draw
from rl_tui.common.errors import UserError
from rl_tui.common.streams import streams
from rl_tui.worlds.mdp.tabular_mdp import Outcome, TabularMDP, Transition, tabular_mdp

pytestmark = pytest.mark.xdist_group("policies")  # each policy's loop is compiled once


# The gradient bandit


def plain_gradient(
    means: list[float], alpha: float, baseline: bool, seed: int, steps: int
) -> tuple[list[tuple[int, float]], list[float]]:
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
    hyperparameters = Hyperparameters(policy="gradient", alpha=0.1, baseline="mean" if baseline else "none")
    for seed in range(5):
        ours = learner(gaussian(means), hyperparameters, seed)
        taken, preferences = plain_gradient(means, 0.1, baseline, seed, 200)
        assert pulls(ours, 200) == taken
        assert ours.rule.preference.tolist() == pytest.approx(preferences, rel=1e-9, abs=1e-12)
        assert ours.rule.probability.sum() == pytest.approx(1.0)


def test_the_gradient_bandit_learns_with_the_step_size_of_the_episode() -> None:
    hyperparameters = Hyperparameters(
        policy="gradient", alpha=0.5, step_size_schedule="linear", alpha_decay=0.5, baseline="none"
    )
    ours = learner(gaussian([1.0, 1.0], std=0.0), hyperparameters)
    ours.advance(1)
    learned = ours.rule.preference.tolist()
    assert sorted(learned) == [-0.25, 0.25]
    ours.advance(20)
    assert ours.rule.preference.tolist() == learned


def test_the_expectation_of_the_gradient_bandit_is_that_of_its_probabilities() -> None:
    ours = learner(TESTBED, Hyperparameters(policy="gradient"))
    ours.advance(50)
    wanted = float(ours.rule.probability @ ours.q)
    assert expectation(ours.rule, ours.q, ours.visits, 0, 4) == pytest.approx(wanted)


def test_the_gradient_bandit_prefers_what_paid_by_hand() -> None:
    ours = learner(certain(0.0, 1.0), Hyperparameters(alpha=0.5, policy="gradient"))
    ours.take(0)
    ours.take(1)
    assert isinstance(ours.rule, gradient.Rule)
    # R̄ = 0, the reward is 1: ± α (R − R̄) / 2
    assert ours.rule.preference.tolist() == [-0.25, 0.25]


# Thompson sampling


@pytest.mark.parametrize(("successes", "failures"), [(0, 0), (3, 1), (0, 40), (500, 20)])
def test_draws_of_a_probability_follow_the_beta_distribution(successes: int, failures: int) -> None:
    from scipy import stats  # slow to import

    generator = np.random.default_rng(7)
    drawn = [beta_draw(float(successes), float(failures), generator) for _ in range(4000)]
    assert stats.kstest(drawn, stats.beta(1 + successes, 1 + failures).cdf).pvalue > 1e-3


@pytest.mark.parametrize(("count", "total", "variance"), [(0, 0.0, 1.0), (4, 8.0, 1.0), (9, -3.0, 4.0)])
def test_draws_of_a_mean_follow_the_normal_posterior(count: int, total: float, variance: float) -> None:
    from scipy import stats  # slow to import

    # Conjugate prior: precisions add up, and the mean is weighted by them
    precision = 1.0 + count / variance
    posterior = stats.norm(total / variance / precision, 1.0 / math.sqrt(precision))
    generator = np.random.default_rng(8)
    drawn = [normal_draw(count, total, variance, generator) for _ in range(4000)]
    assert stats.kstest(drawn, posterior.cdf).pvalue > 1e-3


def test_gamma_draws_are_the_same_bits_interpreted() -> None:
    one, other = np.random.default_rng(9), np.random.default_rng(9)
    shapes = [1.0, 1.5, 2.0, 30.0, 1e6] * 200
    compiled = machine_code(gamma_draw)
    assert [compiled(each, one) for each in shapes] == [gamma_draw(each, other) for each in shapes]


def test_thompson_sampling_counts_what_its_arms_paid() -> None:
    ours = learner(COINS, Hyperparameters(policy="thompson"))
    paid = pulls(ours, 200)
    assert ours.rule.bernoulli
    assert ours.rule.rewards.tolist() == [sum(arm == each for each, _ in paid) for arm in range(4)]
    assert ours.rule.total.tolist() == [
        sum(reward for each, reward in paid if each == arm) for arm in range(4)
    ]


@pytest.mark.parametrize(
    ("mdp", "is_bernoulli", "variance"),
    [
        (COINS, True, [0.16, 0.09, 0.25, 0.0]),
        (TESTBED, False, [1.0] * 4),
        (gaussian([0.5, 2.0], std=0.0), False, [0.0] * 2),
        (replace(gaussian([0.0, 0.0], std=0.0), drift_std=0.1), False, [0.0] * 2),
        (bandit_of([[Outcome(0.5, 0, 2.0, True, 1.0), Outcome(0.5, 0, 0.0, True)]]), False, [1.5]),
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
    from scipy import stats  # slow to import

    # Both arms pay the same: once each is known, every draw is a tie
    ours = learner(gaussian([4.0, 4.0], std=0.0), Hyperparameters(policy="thompson", ties=ties))
    ours.rule.rewards[:] = 1
    ours.rule.total[:] = 4.0
    ours.advance(100)
    assert [count > 0 for count in ours.visits.tolist()] == pulled
    if ties == "random":
        assert stats.binomtest(int(ours.visits[0]), 100).pvalue > 1e-3


def test_nobody_is_given_an_expectation_that_has_no_closed_form() -> None:
    rule = new_rule(Hyperparameters(policy="thompson"))
    assert math.isnan(expectation(rule, np.zeros(4), NO_VISITS, 0, 4))


def test_thompson_sampling_counts_what_was_pulled_by_hand() -> None:
    ours = learner(certain(0.0, 1.0), Hyperparameters(policy="thompson"))
    for arm in (1, 1, 0):
        ours.take(arm)
    assert isinstance(ours.rule, thompson.Rule)
    assert (ours.rule.rewards.tolist(), ours.rule.total.tolist()) == ([1, 2], [0.0, 2.0])


# Both


def two_states() -> TabularMDP:
    return tabular_mdp(
        ["here", "there"],
        ["go"],
        [Transition(0, 0, [Outcome(1.0, 1, 0.0, False)]), Transition(1, 0, [Outcome(1.0, 1, 0.0, True)])],
        {0: 1.0},
    )


@pytest.mark.parametrize(
    ("mdp", "hyperparameters", "message"),
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
def test_what_cannot_work_is_refused_in_one_line(
    mdp: TabularMDP, hyperparameters: dict[str, Any], message: str
) -> None:
    def refused(act: Callable[[], object]) -> None:
        with pytest.raises(UserError, match=message) as error:
            act()
        assert len(str(error.value).splitlines()) == 1

    unfit = Hyperparameters(**hyperparameters)
    refused(lambda: learner(mdp, unfit))
    ours = learner(mdp, Hyperparameters())
    refused(lambda: ours.configure(unfit))
    ours.advance(5)
