"""Exact numbers of any policy."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import NamedTuple

import numpy as np
import pytest
from exact_reference import (
    lake,
    live,
    probabilities,
    return_within,
    solve_rational,
    student,
    world,
    worlds_and_policies,
)
from hypothesis import given, settings

from rl_tui.agents.exact import policy_figures as expected_visits
from rl_tui.agents.exact.policy_figures import (
    chance_of_ending,
    expected_return,
    figures,
    softened,
    uniform_over,
    uniform_policy,
)
from rl_tui.agents.exact.solve import solve
from rl_tui.worlds.mdp.space import FloatArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

quick = settings(max_examples=60, deadline=None)
EPISODES = 1_000_000


class Simulated(NamedTuple):
    returns: FloatArray
    lengths: FloatArray


def simulated(mdp: TabularMDP, policy: FloatArray, steps: int) -> Simulated:
    """Play episodes of at most ``steps`` steps, all at once. The world has a single start."""
    generator = np.random.default_rng(0)
    # all outcomes of a state, in a row on [state, state + 1)
    weight = policy[mdp.outcome_pair] * mdp.probability
    owner = mdp.pair_state[mdp.outcome_pair]
    edges = np.cumsum(weight)
    first = np.concatenate(([0.0], edges))[np.searchsorted(owner, np.arange(mdp.states))]
    returns, lengths = np.zeros((2, EPISODES))
    playing = np.arange(EPISODES)
    state = np.full(EPISODES, mdp.start_state[0])
    for _ in range(steps):
        draw = first[state] + generator.random(len(state))
        outcome = np.minimum(np.searchsorted(edges, draw, side="right"), len(edges) - 1)
        returns[playing] += mdp.reward[outcome]
        lengths[playing] += 1
        goes_on = ~mdp.terminated[outcome]
        playing, state = playing[goes_on], mdp.next_state[outcome[goes_on]]
    return Simulated(returns, lengths)


def is_the_mean_of(value: float | None, sample: FloatArray) -> bool:
    """Return whether it is within four standard errors."""
    assert value is not None
    return abs(value - sample.mean()) <= 4 * sample.std() / np.sqrt(len(sample))


def rational_values(
    mdp: TabularMDP, policy: list[float], gamma: Fraction, reward: FloatArray
) -> dict[int, Fraction]:
    """Solve v = E[R + γ v(S′)] in fractions."""
    states = live(mdp)
    matrix = [[Fraction(int(state == other)) for other in states] for state in states]
    right = [Fraction(0)] * len(states)
    for row, state in enumerate(states):
        total = sum(Fraction(policy[pair]) for pair in mdp.pairs_of(state))
        for pair in mdp.pairs_of(state):
            for outcome, p in zip(mdp.outcomes_of(pair), probabilities(mdp, pair), strict=True):
                chance = p * Fraction(policy[pair]) / total
                right[row] += chance * Fraction(float(reward[outcome]))
                if not mdp.terminated[outcome]:
                    matrix[row][states.index(int(mdp.next_state[outcome]))] -= gamma * chance
    return dict(zip(states, solve_rational(matrix, right), strict=True))


def at_start(mdp: TabularMDP, values: dict[int, Fraction]) -> float:
    starts = zip(mdp.start_state, mdp.start_probability, strict=True)
    return float(sum(Fraction(float(p)) * values[int(state)] for state, p in starts))


def test_random_steps_on_the_lake_as_known_and_as_a_million_episodes_have_it() -> None:
    mdp = lake("4x4", False, 100)
    policy = uniform_policy(mdp)
    found = figures(mdp, policy, 0.99)
    assert found.expected_return == pytest.approx(0.013939795959171436, rel=1e-13)
    assert found.expected_return == pytest.approx(expected_return(mdp, policy), rel=1e-13)
    episodes = simulated(mdp, policy, 100)
    assert is_the_mean_of(found.expected_return, episodes.returns)
    assert is_the_mean_of(found.steps, episodes.lengths)


@pytest.mark.exhaustive("iterates for long")
def test_the_best_way_over_a_slippery_lake_with_a_random_step_now_and_then() -> None:
    mdp = lake("4x4", True, 100)
    policy = softened(mdp, uniform_over(mdp, solve(mdp, 0.99).greedy), 0.1)
    found = figures(mdp, policy, 0.99)
    assert found.expected_return == pytest.approx(0.4055262082214294, rel=1e-13)
    episodes = simulated(mdp, policy, 100)
    assert is_the_mean_of(found.expected_return, episodes.returns)
    assert is_the_mean_of(found.steps, episodes.lengths)


def test_the_student_who_does_anything() -> None:
    mdp = student()
    found = figures(mdp, uniform_policy(mdp), 0.9)
    assert found.v is not None
    named = dict(zip(mdp.state_names, found.v, strict=True))
    # Class = ½ (−2 + γ (.8 · 10 + .2 Class)) + ½ γ Phone, Phone = ½ (−1 + γ Phone) + ½ γ Class
    assert (named["Class"], named["Phone"]) == (
        pytest.approx(4.0436, abs=5e-5),
        pytest.approx(2.3993, abs=5e-5),
    )
    assert named["Phone"] == pytest.approx(0.5 * (-1 + 0.9 * named["Phone"]) + 0.45 * named["Class"])
    assert (named["Pass"], named["Sleep"]) == (10.0, 0.0)
    assert found.value_at_start == named["Class"]


def test_a_way_of_three_steps_has_three_steps_and_a_limit_cuts_them() -> None:
    way = [(f"s{n}", "on", [(1.0, f"s{n + 1}", -2.0)]) for n in range(3)]
    for limit, steps in ((0, 3.0), (5, 3.0), (3, 3.0), (2, 2.0)):
        found = figures(world(*way, time_limit=limit), np.ones(3), 0.5)
        assert (found.expected_return, found.steps) == (-2.0 * steps, steps)
        assert found.ends == (1.0 if steps == 3.0 else 0.0)
        assert found.value_at_start == -3.5  # never cut


def test_where_a_policy_may_never_end_it_has_no_length_without_a_limit() -> None:
    loop = [
        ("here", "stay", [(1.0, "here", 0.0)]),
        ("here", "go", [(0.5, "end", 1.0), (0.5, "pit", 0.0)]),
        ("pit", "stay", [(1.0, "pit", 0.0)]),
    ]
    endless = figures(world(*loop), np.array([0.5, 0.5, 1.0]), 1.0)
    assert (endless.steps, endless.ends, endless.expected_return) == (None, pytest.approx(0.5), 0.5)
    limited = figures(world(*loop, time_limit=8), np.array([1.0, 0.0, 1.0]), 1.0)
    assert (limited.steps, limited.ends, limited.expected_return) == (8.0, 0.0, 0.0)


def test_a_part_without_end_that_is_never_met_leaves_the_length() -> None:
    mdp = world(
        ("here", "go", [(0.25, "end", 1.0), (0.75, "here", 0.0)]),
        ("here", "fall", [(1.0, "pit", 0.0)]),
        ("pit", "stay", [(1.0, "pit", -1.0)]),
    )
    found = figures(mdp, np.array([1.0, 0.0, 1.0]), 1.0)
    assert (found.steps, found.ends, found.expected_return) == (pytest.approx(4.0), 1.0, pytest.approx(1.0))
    assert np.isnan(found.v[mdp.state_names.index("pit")])


@quick
@given(worlds_and_policies())
def test_values_and_lengths_are_those_of_fractions(drawn: tuple[TabularMDP, list[float]]) -> None:
    mdp, policy = drawn
    found = figures(mdp, np.array(policy), 0.9)
    assert found.v is not None
    exact = rational_values(mdp, policy, Fraction(0.9), mdp.reward)
    assert {state: found.v[state] for state in exact} == {
        state: pytest.approx(float(value), abs=1e-9) for state, value in exact.items()
    }
    assert (found.steps is not None) == (found.ends == 1.0)
    if found.steps is not None and not np.isnan(found.v).any():
        try:
            lengths = rational_values(mdp, policy, Fraction(1), np.ones(len(mdp.reward)))
        except StopIteration:  # an endless part, away from the start
            return
        assert found.steps == pytest.approx(at_start(mdp, lengths), rel=1e-9)


@quick
@given(worlds_and_policies(time_limit=9))
def test_figures_within_a_limit_are_those_of_plain_sweeps(drawn: tuple[TabularMDP, list[float]]) -> None:
    mdp, policy = drawn
    found = figures(mdp, np.array(policy), 0.9)
    of_one_a_step = replace(mdp, reward=np.ones(len(mdp.reward)))
    of_one_at_the_end = replace(mdp, reward=mdp.terminated.astype(np.float64))
    assert found.expected_return == pytest.approx(return_within(mdp, policy, 9), abs=1e-12)
    assert found.steps == pytest.approx(return_within(of_one_a_step, policy, 9), abs=1e-12)
    assert found.ends == pytest.approx(return_within(of_one_at_the_end, policy, 9), abs=1e-12)
    assert found.ends == chance_of_ending(mdp, np.array(policy))


def test_large_worlds_are_worked_out_as_small_ones(monkeypatch: pytest.MonkeyPatch) -> None:
    mdp = lake("8x8", True, 200)
    policy = uniform_policy(mdp)
    dense = figures(mdp, policy, 1.0)
    monkeypatch.setattr(expected_visits, "MOST_DENSE", 0)
    sparse = figures(mdp, policy, 1.0)
    assert sparse.expected_return == pytest.approx(dense.expected_return, rel=1e-13)
    assert sparse.steps == pytest.approx(dense.steps, rel=1e-13)
    assert sparse.ends == pytest.approx(dense.ends, rel=1e-13)


@pytest.mark.parametrize("limit", [511, 512, 997, 100_000])
def test_a_long_limit_is_worked_out_as_step_by_step(limit: int) -> None:
    for mdp in (lake("4x4", True, limit), student(limit)):
        policy = softened(mdp, uniform_over(mdp, solve(mdp, 0.9).greedy), 0.5)
        found = figures(mdp, policy, 0.9)
        assert found.expected_return == pytest.approx(expected_return(mdp, policy), rel=1e-12)
        of_one_a_step = replace(mdp, reward=np.ones(len(mdp.reward)))
        assert found.steps == pytest.approx(expected_return(of_one_a_step, policy), rel=1e-12)
