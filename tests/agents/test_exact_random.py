"""Exact values of random worlds, computed a second way."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from exact_reference import (
    best_rational,
    deterministic_policies,
    leads_to,
    live,
    policy_iteration_of_the_box,
    rational_values,
    recurrent,
    return_within,
    worlds,
    worlds_and_policies,
)
from hypothesis import given, settings
from hypothesis import strategies as st
from policy_worth import evaluate

from rl_tui.agents.exact.backward_induction import best_values, policy_values
from rl_tui.agents.exact.policy_evaluation import NoExactAnswer
from rl_tui.agents.exact.policy_figures import figures, uniform_over
from rl_tui.agents.exact.solve import best_expected_return, returns, solve
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP

quick = settings(max_examples=60, deadline=None)
PolicyInWorld = tuple[TabularMDP, list[float]]


@quick
@given(worlds(states=6), st.sampled_from([0.0, 0.5, 0.9]))
def test_the_same_values_as_the_box(mdp: TabularMDP, gamma: float) -> None:
    assert solve(mdp, gamma).v == pytest.approx(policy_iteration_of_the_box(mdp, gamma), abs=1e-9)


@quick
@given(worlds(states=6), st.sampled_from([0.3, 0.95]))
def test_the_same_values_as_long_value_iteration(mdp: TabularMDP, gamma: float) -> None:
    assert solve(mdp, gamma).v == pytest.approx(best_values(mdp, gamma, 2_000), abs=1e-9)


@quick
@given(worlds(largest_reward=1_000_000, states=3), st.sampled_from([0.9, 0.9999, 0.999999]))
def test_exact_to_the_last_digits_where_gamma_is_near_one(mdp: TabularMDP, gamma: float) -> None:
    best = best_rational(mdp, Fraction(gamma))
    for state, value in best.items():
        assert abs(Fraction(float(solve(mdp, gamma).v[state])) - value) <= Fraction(1e-9) + abs(value) / 2**51


@quick
@given(worlds())
def test_undiscounted_the_best_policy_that_ends_or_a_refusal(mdp: TabularMDP) -> None:
    best = best_rational(mdp, Fraction(1))
    if best is None:
        with pytest.raises(NoExactAnswer):
            solve(mdp, 1.0)
        assert best_expected_return(mdp) is None
    else:
        solution = solve(mdp, 1.0)
        assert {state: pytest.approx(float(v), abs=1e-9) for state, v in best.items()} == {
            state: solution.v[state] for state in live(mdp)
        }
        assert returns(mdp, solution).best_expected_return == solution.value_at_start


@quick
@given(worlds(), st.sampled_from([0.5, 0.99, 1.0]))
def test_values_satisfy_the_optimality_equation_and_ties_are_marked(mdp: TabularMDP, gamma: float) -> None:
    try:
        solution = solve(mdp, gamma)
    except NoExactAnswer:
        return
    for state in live(mdp):
        own = solution.q[list(mdp.pairs_of(state))]
        assert solution.v[state] == pytest.approx(own.max(), abs=1e-11)
        assert solution.greedy[list(mdp.pairs_of(state))].any()
        assert all(
            solution.best[p] == (solution.q[p] >= own.max() - 1e-9) or abs(own.max() - solution.q[p]) < 2e-9
            for p in mdp.pairs_of(state)
        )
    assert not (solution.greedy & ~solution.best).any()
    found = evaluate(mdp, uniform_over(mdp, solution.greedy), gamma)
    assert found.at_start == pytest.approx(solution.value_at_start, abs=1e-6)


@settings(max_examples=150, deadline=None)
@given(worlds(largest_reward=1))
def test_undiscounted_every_choice_among_the_greedy_pairs_ends_and_is_worth_v(mdp: TabularMDP) -> None:
    try:
        solution = solve(mdp, 1.0)
    except NoExactAnswer:
        return
    endless = False
    for policy in deterministic_policies(mdp):
        loops = any(recurrent(mdp, list(policy.values()), state) for state in policy)
        endless = endless or (loops and all(solution.best[pair] for pair in policy.values()))
        if all(solution.greedy[pair] for pair in policy.values()):
            assert not loops
            values = rational_values(mdp, policy, Fraction(1))
            assert [float(values[state]) for state in live(mdp)] == pytest.approx(solution.v[live(mdp)])
    assert endless == (solution.greedy.tolist() != solution.best.tolist())


@quick
@given(worlds_and_policies(time_limit=7))
def test_returns_within_a_time_limit(drawn: PolicyInWorld) -> None:
    mdp, policy = drawn
    found = figures(mdp, np.array(policy), 0.9)
    assert found.expected_return == pytest.approx(return_within(mdp, policy, 7), abs=1e-12)
    assert best_expected_return(mdp) == pytest.approx(return_within(mdp, None, 7), abs=1e-12)


@quick
@given(worlds_and_policies())
def test_returns_without_a_time_limit(drawn: PolicyInWorld) -> None:
    mdp, policy = drawn
    pairs = [pair for pair in range(mdp.pairs) if policy[pair] > 0]
    reached = {state for start in mdp.start_state for state in leads_to(mdp, pairs, int(start))}
    forever = [state for state in reached if state is not None and recurrent(mdp, pairs, state)]
    pays = any(
        mdp.reward[outcome] != 0
        for state in forever
        for pair in set(pairs) & set(mdp.pairs_of(state))
        for outcome in mdp.outcomes_of(pair)
    )
    found = figures(mdp, np.array(policy), 1.0)
    assert (found.value_at_start is None) == (found.expected_return is None) == pays
    if not pays:
        far = policy_values(mdp, np.array(policy), 100_000)[mdp.start_state]
        assert found.expected_return == pytest.approx(float(far @ mdp.start_probability), abs=1e-8)
    ends = policy_values(mdp, np.array(policy), 100_000, mdp.terminated.astype(np.float64))[mdp.start_state]
    assert found.ends == pytest.approx(float(ends @ mdp.start_probability), abs=1e-8)
    assert (found.ends == 1.0) == (not forever)


@quick
@given(worlds_and_policies(), st.sampled_from([0.0, 0.7, 0.99]))
def test_evaluation_satisfies_the_bellman_equation(drawn: PolicyInWorld, gamma: float) -> None:
    mdp, policy = drawn
    v = evaluate(mdp, np.array(policy), gamma).v
    for state in live(mdp):
        backup = sum(
            policy[pair]
            * mdp.probability[outcome]
            * (mdp.reward[outcome] + (0.0 if mdp.terminated[outcome] else gamma * v[mdp.next_state[outcome]]))
            for pair in mdp.pairs_of(state)
            for outcome in mdp.outcomes_of(pair)
        )
        assert v[state] == pytest.approx(backup, abs=1e-10)
