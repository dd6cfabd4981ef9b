"""Worlds that never end."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from exact_reference import student, world
from policy_worth import evaluate

from rl_tui.agents.exact.policy_evaluation import NoExactAnswer, always_ends
from rl_tui.agents.exact.policy_figures import figures, uniform_over
from rl_tui.agents.exact.solve import best_expected_return, greedy_return, returns, solve

OUT = ("A", "out", [(1.0, "end", 0.0)])
TRAP = [OUT, ("A", "in", [(1.0, "Trap", 0.0)]), ("Trap", "stay", [(1.0, "Trap", 0.0)])]
LOOP = [
    *(OUT, ("A", "in", [(1.0, "B", 3.0)]), ("B", "back", [(0.5, "A", -2.9), (0.5, "C", -2.9)])),
    *(("C", "back", [(1.0, "A", 0.0)]), ("C", "out", [(1.0, "end", 0.0)])),
]
ON_THE_WAY = [
    *(OUT, ("A", "on", [(1.0, "B", 0.0)])),
    *(("B", "out", [(1.0, "end", 0.0)]), ("B", "stay", [(1.0, "B", 1.0)])),
]
RING = [(f"s{i}", "on", [(1.0, f"s{(i + 1) % 20}", 1.0)]) for i in range(20)]
UNLIKELY = [("A", "on", [(1.0, "B", -1.0)]), ("B", "back", [(1.0 - 1e-12, "A", -1.0), (1e-300, "end", -1.0)])]


@pytest.mark.parametrize(
    ("pairs", "said"),
    [
        (TRAP, r"^γ = 1: state Trap cannot reach a terminal state; choose γ below 1$"),
        (LOOP, r"^γ = 1: the loop through A, B, C earns without end; choose γ below 1$"),
        (ON_THE_WAY, "the loop through B earns"),
        ([*RING, ("s0", "out", [(1.0, "end", 0.0)])], "through s0, s1, s2, s3, s4, s5, 14 more earns"),
        (UNLIKELY, "a terminal state is too unlikely"),
    ],
    ids=["trap", "loop", "only the loop", "a long loop", "an unlikely end"],
)
def test_what_has_no_value_is_refused_by_name(pairs: list[Any], said: str) -> None:
    with pytest.raises(NoExactAnswer, match=said):
        solve(world(*pairs), 1.0)


def test_a_trap_leaves_no_best_return() -> None:
    mdp = world(*TRAP)
    assert returns(mdp, solve(mdp, 0.9)).best_expected_return is None
    assert best_expected_return(mdp) is None


def test_a_loop_that_costs_nothing_is_no_obstacle() -> None:
    mdp = student(time_limit=0)
    solution = solve(mdp, 1.0)
    assert solution.v == pytest.approx([7.5, 7.5, 10.0, 0.0], abs=1e-12)
    assert returns(mdp, solution) == (7.5, 7.5)


def test_the_best_policy_that_ends_may_be_worse_than_one_that_does_not() -> None:
    # Staying would cost nothing, but V* is the best over the policies that end
    mdp = world(("A", "stay", [(1.0, "A", 0.0)]), ("A", "out", [(1.0, "end", -5.0)]))
    assert solve(mdp, 1.0).v.tolist() == [-5.0, 0.0]
    assert solve(mdp, 0.9).v.tolist() == [0.0, 0.0]


def test_a_loop_that_balances_is_no_gain() -> None:
    mdp = world(
        ("A", "in", [(1.0, "B", 0.1)]), ("A", "out", [(1.0, "end", 1.0)]), ("B", "back", [(1.0, "A", -0.1)])
    )
    assert solve(mdp, 1.0).v[0] == pytest.approx(1.0, abs=1e-12)


def test_an_endless_policy_that_pays_nothing_adds_nothing() -> None:
    mdp = world(("A", "in", [(0.5, "B", 5.0), (0.5, "end", 1.0)]), ("B", "stay", [(1.0, "B", 0.0)]))
    found = figures(mdp, np.ones(2), 1.0)
    assert (found.value_at_start, found.expected_return, found.ends) == (3.0, 3.0, 0.5)


@pytest.mark.parametrize("reward", [1.0, -1.0])
def test_an_endless_policy_that_pays_has_no_return(reward: float) -> None:
    mdp = world(("A", "in", [(0.75, "B", 5.0), (0.25, "end", 1.0)]), ("B", "stay", [(1.0, "B", reward)]))
    undiscounted = figures(mdp, np.ones(2), 1.0)
    assert (undiscounted.value_at_start, undiscounted.expected_return) == (None, None)
    assert undiscounted.ends == 0.25
    discounted = figures(mdp, np.ones(2), 0.5)
    assert discounted.value_at_start == pytest.approx(4.0 + 0.75 * reward, abs=1e-12)
    assert discounted.expected_return is None


def test_an_endless_part_that_the_policy_never_meets_does_not_matter() -> None:
    mdp = world(
        ("A", "out", [(1.0, "end", 2.0)]), ("A", "in", [(1.0, "B", 0.0)]), ("B", "stay", [(1.0, "B", 1.0)])
    )
    policy = np.array([1.0, 0.0, 1.0])
    found = figures(mdp, policy, 1.0)
    assert (found.value_at_start, found.expected_return, found.ends) == (2.0, 2.0, 1.0)
    values = evaluate(mdp, policy, 1.0)
    assert values.v[0] == values.at_start == 2.0
    assert np.isnan(values.v[mdp.state_names.index("B")])


def test_a_time_limit_bounds_the_return_but_not_the_value() -> None:
    mdp = world(("A", "stay", [(1.0, "A", 1.0)]), ("A", "out", [(1.0, "end", 0.0)]), time_limit=10)
    found = figures(mdp, np.array([1.0, 0.0]), 1.0)
    assert (found.value_at_start, found.expected_return, found.ends) == (None, 10.0, 0.0)
    assert best_expected_return(mdp) == 10.0


def test_an_end_too_unlikely_spoils_only_the_figures_that_need_it() -> None:
    unlimited = world(*UNLIKELY)
    solution = solve(unlimited, 0.5)
    assert solution.value_at_start == pytest.approx(-2.0, abs=1e-9)
    assert returns(unlimited, solution) == (None, None)
    found = figures(unlimited, np.ones(2), 0.5)
    assert found.value_at_start == pytest.approx(-2.0, abs=1e-9)
    assert (found.expected_return, found.ends) == (None, 1.0)
    limited = figures(world(*UNLIKELY, time_limit=10), np.ones(2), 1.0)
    assert limited.value_at_start is None
    assert limited.expected_return == pytest.approx(-10.0, abs=1e-9)
    assert limited.ends == pytest.approx(5e-300, rel=1e-6)


def test_a_discount_one_bit_below_one_still_has_its_value() -> None:
    gamma = 1.0 - 2.0**-53
    mdp = world(("A", "on", [(1.0, "B", 1.0)]), ("B", "back", [(1.0, "A", 1.0)]))
    assert solve(mdp, gamma).value_at_start == pytest.approx(2.0**53, rel=1e-12)


def test_at_gamma_1_no_greedy_pair_goes_round_for_ever() -> None:
    mdp = student()
    solution = solve(mdp, 1.0)
    study, check_phone, _scroll, leave, sleep = range(5)
    assert np.flatnonzero(solution.best).tolist() == [study, check_phone, leave, sleep]
    assert np.flatnonzero(solution.greedy).tolist() == [study, leave, sleep]
    assert greedy_return(mdp, solution) == pytest.approx(7.5, abs=1e-12)
    assert figures(mdp, uniform_over(mdp, solution.greedy), 1.0).ends == pytest.approx(1.0)


def test_a_tie_that_leads_to_an_end_sooner_or_later_stays() -> None:
    # one wait is as good as going, and so is the detour: it loses nothing
    mdp = world(
        ("A", "go", [(1.0, "end", 1.0)]),
        ("A", "wait", [(1.0, "B", 0.0)]),
        ("B", "go", [(1.0, "end", 1.0)]),
        ("B", "try", [(0.5, "B", 0.0), (0.5, "end", 1.0)]),
    )
    assert solve(mdp, 1.0).greedy.all()


def test_whether_a_policy_always_ends_counts_from_the_start() -> None:
    mdp = student(time_limit=0)
    assert always_ends(mdp, np.array([1.0, 0.0, 1.0, 0.0, 1.0]))
    assert not always_ends(mdp, np.array([0.0, 1.0, 0.0, 1.0, 1.0]))
    assert always_ends(mdp, np.array([0.5, 0.5, 0.0, 1.0, 1.0]))
