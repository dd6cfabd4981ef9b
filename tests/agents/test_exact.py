"""Exact values, compared with known ones."""

from __future__ import annotations

import numpy as np
import pytest
from exact_reference import lake, student, world
from policy_worth import evaluate

from rl_tui.agents.exact import policy_evaluation
from rl_tui.agents.exact.policy_figures import expected_return, figures, greedy_policy, uniform_over
from rl_tui.agents.exact.solve import best_expected_return, greedy_return, returns, solve
from rl_tui.worlds.mdp.tabular_mdp import Outcome, Transition, tabular_mdp


@pytest.mark.parametrize(
    ("map_name", "slippery", "value"),
    [("4x4", False, 0.95099), ("4x4", True, 0.54203), ("8x8", False, 0.87752), ("8x8", True, 0.41464)],
)
def test_frozen_lake_value_at_start(map_name: str, slippery: bool, value: float) -> None:
    assert solve(lake(map_name, slippery), 0.99).value_at_start == pytest.approx(value, abs=1e-5)


def test_a_lake_that_does_not_slip_is_worth_its_six_steps() -> None:
    mdp = lake("4x4", False, 100)
    solution = solve(mdp, 0.99)
    assert solution.value_at_start == pytest.approx(0.99**5, abs=1e-14)
    assert solution.v[14] == pytest.approx(1.0, abs=1e-14)
    assert returns(mdp, solution) == (1.0, 1.0)


def test_holes_and_goal_of_the_lake_are_worth_nothing() -> None:
    solution = solve(lake("4x4", True), 0.99)
    assert [solution.v[state] for state in (5, 7, 11, 12, 15)] == [0.0] * 5


def test_ties_of_the_lake() -> None:
    mdp = lake("4x4", False)
    greedy = solve(mdp, 0.99).greedy
    tied = [
        [mdp.action_names[mdp.pair_action[p]] for p in mdp.pairs_of(state) if greedy[p]]
        for state in (0, 1, 14)
    ]
    assert tied == [["down", "right"], ["right"], ["right"]]


def test_the_lake_without_discount_ends_although_walls_cost_nothing() -> None:
    mdp = lake("4x4", True, 100)
    solution = solve(mdp, 1.0)
    assert solution.value_at_start == pytest.approx(14 / 17, abs=1e-12)
    unlimited = figures(lake("4x4", True), uniform_over(mdp, solution.greedy), 1.0)
    assert unlimited.value_at_start == pytest.approx(14 / 17, abs=1e-9)
    assert unlimited.ends == 1.0


def test_a_clock_helps_on_the_lake_and_the_limit_hurts() -> None:
    mdp = lake("4x4", True, 100)
    earned = returns(mdp, solve(mdp, 0.99))
    assert earned.expected_return is not None
    assert earned.best_expected_return is not None
    assert earned.expected_return < earned.best_expected_return < 14 / 17


def test_the_student_evening_by_hand() -> None:
    mdp = student()
    solution = solve(mdp, 0.9)
    study = 5.2 / 0.82
    assert mdp.state_names == ("Class", "Phone", "Pass", "Sleep")
    assert solution.v == pytest.approx([study, 0.9 * study, 10.0, 0.0], abs=1e-12)
    # study, check phone, then scroll, quit, then sleep
    assert solution.q == pytest.approx([study, 0.81 * study, -1 + 0.81 * study, 0.9 * study, 10], abs=1e-12)
    assert greedy_return(mdp, solution) == pytest.approx(7.5, abs=1e-12)


@pytest.mark.parametrize(("gamma", "action"), [(0.2499, "check phone"), (0.2501, "study")])
def test_below_a_quarter_the_best_evening_never_studies(gamma: float, action: str) -> None:
    mdp = student()
    greedy = solve(mdp, gamma).greedy
    assert [mdp.action_names[mdp.pair_action[p]] for p in mdp.pairs_of(0) if greedy[p]] == [action]


def test_at_a_quarter_study_and_phone_tie() -> None:
    mdp = student()
    assert [bool(solve(mdp, 0.25).greedy[p]) for p in mdp.pairs_of(0)] == [True, True]


def test_an_evening_that_never_studies_is_worth_nothing_and_never_ends() -> None:
    mdp = student()
    policy = greedy_policy(mdp, solve(mdp, 0.1).q, "random")
    assert figures(mdp, policy, 0.1).value_at_start == 0.0
    assert figures(mdp, policy, 0.1).expected_return == 0.0
    assert figures(mdp, policy, 0.1).ends == 0.0


def test_a_bandit_is_its_means() -> None:
    arms = [0.5, 2.0, -1.0, 2.0]
    transitions = [
        Transition(0, a, [Outcome(1.0, 0, mean, True, reward_std=1.0)]) for a, mean in enumerate(arms)
    ]
    mdp = tabular_mdp(["bandit"], [f"arm {a}" for a in range(4)], transitions, {0: 1.0}, 0)
    solution = solve(mdp, 1.0)
    assert solution.q.tolist() == arms
    assert solution.greedy.tolist() == [False, True, False, True]
    assert solution.value_at_start == 2.0
    assert returns(mdp, solution) == (2.0, 2.0)


def test_value_at_start_averages_over_the_start() -> None:
    mdp = world(
        ("A", "go", [(1.0, "end", 4.0)]),
        ("B", "go", [(1.0, "end", 8.0)]),
        start={"A": 0.25, "B": 0.75},
        time_limit=3,
    )
    assert solve(mdp, 0.5).value_at_start == 7.0
    assert best_expected_return(mdp) == 7.0
    assert figures(mdp, np.ones(2), 0.5).expected_return == 7.0


def test_gamma_zero_looks_at_the_next_reward_only() -> None:
    mdp = world(
        ("A", "low", [(1.0, "B", 1.0)]), ("A", "high", [(1.0, "end", 2.0)]), ("B", "go", [(1.0, "end", 99.0)])
    )
    solution = solve(mdp, 0.0)
    assert solution.q.tolist() == [1.0, 2.0, 99.0]
    assert solution.greedy.tolist() == [False, True, True]


@pytest.mark.parametrize("gamma", [-0.1, 1.1, float("nan")])
def test_gamma_out_of_range_is_refused(gamma: float) -> None:
    with pytest.raises(ValueError, match=r"expected a number in \[0, 1\]"):
        solve(student(), gamma)


def test_best_return_with_a_clock_takes_the_risk_late() -> None:
    # Waiting pays 1 a step. The jump pays 10 and ends: with 4 steps, wait three times and jump
    mdp = world(
        ("A", "wait", [(1.0, "A", 1.0)]), ("A", "jump", [(0.5, "end", 20.0), (0.5, "end", 0.0)]), time_limit=4
    )
    assert best_expected_return(mdp) == 13.0
    assert expected_return(mdp, np.array([1.0, 0.0])) == 4.0
    assert figures(mdp, np.array([0.5, 0.5]), 0.9).ends == 1 - 0.5**4


def test_a_random_walk_of_a_thousand_states_is_exact() -> None:
    # The expected length of the walk from i between 0 and N is i (N − i): a quarter of a million steps
    size = 1_000
    walk = [
        Transition(i, 0, [Outcome(0.5, i - 1, -1.0, i == 1), Outcome(0.5, i + 1, -1.0, i == size - 1)])
        for i in range(1, size)
    ]
    mdp = tabular_mdp([str(i) for i in range(size + 1)], ["step"], walk, {size // 2: 1.0}, 0)
    place = np.arange(size + 1)
    assert np.abs(evaluate(mdp, np.ones(mdp.pairs), 1.0).v + place * (size - place)).max() < 1e-9
    assert np.abs(solve(mdp, 1.0).v + place * (size - place)).max() < 1e-9


@pytest.mark.parametrize("gamma", [0.99, 1.0])
def test_sparse_and_dense_solves_agree(monkeypatch: pytest.MonkeyPatch, gamma: float) -> None:
    mdp = lake("8x8", True)
    dense = solve(mdp, gamma)
    monkeypatch.setattr(policy_evaluation, "MOST_DENSE", 0)
    sparse = solve(mdp, gamma)
    assert np.abs(sparse.q - dense.q).max() < 1e-12
    assert np.array_equal(sparse.greedy, dense.greedy)


def test_probabilities_that_sum_to_almost_one_still_surely_end() -> None:
    third = 0.3333333333
    mdp = world(("A", "go", [(third, "A", -1.0), (third, "A", -1.0), (third, "end", -1.0)]))
    assert solve(mdp, 1.0).value_at_start == pytest.approx(-3.0, abs=1e-12)
    assert figures(mdp, np.ones(1), 1.0).ends == 1.0
