"""Policy iteration in a given order of sweeps (Sutton & Barto, 4.6)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from plain_policy_iteration import plain_policy_iteration
from random_worlds import worlds
from test_planners import any_hyperparameters, shipped
from two_forms import interpreted

from rl_tui.agents.catalogue import SWEEP_PHASES, SweepPhase
from rl_tui.agents.exact.solve import solve
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.kernels.position import Stop
from rl_tui.agents.learner import Learner
from rl_tui.common.errors import UserError
from rl_tui.common.streams import streams
from rl_tui.worlds.mdp.tabular_mdp import Outcome, TabularMDP, Transition, tabular_mdp

FAR = 10**6
ORDERS = st.dictionaries(st.integers(0, 20), st.sampled_from(SWEEP_PHASES), max_size=12)


def planner(mdp: TabularMDP, hyperparameters: Hyperparameters | None = None) -> Learner:
    return Learner(mdp, "policy-iteration", hyperparameters or Hyperparameters(gamma=0.9), streams(0))


def sweep(ours: Learner, phase: SweepPhase) -> Stop:
    ours.order(phase)
    stop = ours.advance(FAR, 1)
    assert ours.phase == phase
    return stop


def ordered(
    mdp: TabularMDP, hyperparameters: Hyperparameters, steps: int, orders: dict[int, SweepPhase]
) -> Learner:
    ours = planner(mdp, hyperparameters)
    number = 0
    while ours.step < steps and not (ours.converged and number not in orders):
        if number in orders:
            ours.order(orders[number])
        ours.advance(steps - ours.step, 1)
        number += 1
    return ours


@given(mdp=worlds(), hyperparameters=any_hyperparameters, steps=st.integers(0, 150), orders=ORDERS)
@settings(max_examples=40, deadline=None)
def test_it_does_what_the_box_says_in_any_order(
    mdp: TabularMDP, hyperparameters: Hyperparameters, steps: int, orders: dict[int, SweepPhase]
) -> None:
    states = sum(1 for state in range(mdp.states) if mdp.pairs_of(state))
    ours = ordered(mdp, hyperparameters, steps, orders)
    q, taken, done = plain_policy_iteration(mdp, hyperparameters, ours.step, orders)
    if done and taken < ours.step:
        return  # the finished sweep was ordered to continue: the box ends there
    assert (ours.q.tolist(), ours.step) == (list(q.values()), taken)
    assert done == (ours.converged and ours.step % states == 0)


@pytest.mark.exhaustive("compiles its loop")
@pytest.mark.compiled
@given(mdp=worlds(), hyperparameters=any_hyperparameters, orders=ORDERS)
@settings(max_examples=15, deadline=None)
def test_machine_code_and_interpreted_give_the_same_bits(
    mdp: TabularMDP, hyperparameters: Hyperparameters, orders: dict[int, SweepPhase]
) -> None:
    fast = ordered(mdp, hyperparameters, 60, orders)
    with interpreted():
        slow = ordered(mdp, hyperparameters, 60, orders)
    assert fast.q.tobytes() == slow.q.tobytes()
    assert [each.tobytes() for each in fast.checkpoint().memory] == [
        each.tobytes() for each in slow.checkpoint().memory
    ]
    assert (fast.step, fast.planning) == (slow.step, slow.planning)


@pytest.mark.parametrize("name", ["frozenlake", "frozenlake-slippery", "student", "book", "bridge"])
@pytest.mark.parametrize("ties", ["random", "first"])
@pytest.mark.parametrize("evaluations", [1, 3])
def test_a_few_evaluations_before_each_improvement_come_to_the_optimum(
    name: str, ties: str, evaluations: int
) -> None:
    mdp, gamma = shipped(name), 0.9
    ours = planner(mdp, replace(Hyperparameters(gamma=gamma, accuracy=1e-13), ties=ties))
    for _ in range(2_000):
        for _ in range(evaluations):
            sweep(ours, "evaluation")
        if sweep(ours, "improvement") is Stop.CONVERGED:
            break
    assert ours.converged
    assert ours.q == pytest.approx(solve(mdp, gamma).q, abs=1e-9)


@given(mdp=worlds(), gamma=st.sampled_from([0.0, 0.5, 0.9]), orders=ORDERS)
@settings(max_examples=40, deadline=None)
def test_wherever_it_believes_to_be_done_it_is(
    mdp: TabularMDP, gamma: float, orders: dict[int, SweepPhase]
) -> None:
    exact = solve(mdp, gamma).q
    ours = planner(mdp, Hyperparameters(gamma=gamma, accuracy=1e-12, initial_q=1.0))
    for number in range(25):
        if number in orders:
            ours.order(orders[number])
        if ours.advance(FAR, 1) is Stop.CONVERGED:
            assert ours.q == pytest.approx(exact, abs=1e-8)
    assert ours.advance(FAR) is Stop.CONVERGED
    assert ours.q == pytest.approx(exact, abs=1e-8)


def stay_or_go() -> TabularMDP:
    """Both actions pay 1 at once, but only one leads to a state without further reward."""
    transitions = [
        Transition(0, 0, [Outcome(1.0, 0, 1.0, False)]),
        Transition(0, 1, [Outcome(1.0, 1, 1.0, False)]),
    ]
    return tabular_mdp(["here", "end"], ["stay", "go"], transitions, {0: 1.0})


@pytest.mark.parametrize("gamma", [0.0, 0.5])
def test_an_improvement_that_changes_nothing_proves_nothing_before_values_are_at_rest(gamma: float) -> None:
    ours = planner(stay_or_go(), Hyperparameters(gamma=gamma, accuracy=1e-12))
    assert sweep(ours, "improvement") is Stop.DONE  # in its view, both are worth 1
    assert ours.planning == "policy 1, improvement: 0 states changed"
    assert sweep(ours, "evaluation") is Stop.DONE
    assert ours.advance(FAR) is Stop.CONVERGED
    assert ours.q == pytest.approx(solve(stay_or_go(), gamma).q)


def test_a_second_improvement_proves_nothing_of_values_of_the_policy_before() -> None:
    ours = planner(shipped("frozenlake"), Hyperparameters(gamma=0.9, accuracy=1e-12))
    while ours.phase != "improvement":  # evaluations until convergence, and the first improvement
        ours.advance(FAR, 1)
    assert not ours.converged
    assert sweep(ours, "improvement") is Stop.DONE
    assert ours.planning == "policy 2, improvement: 0 states changed"
    assert not np.allclose(ours.q, solve(shipped("frozenlake"), 0.9).q)


def test_an_order_in_the_middle_of_a_sweep_is_for_the_next() -> None:
    ours = planner(shipped("frozenlake-slippery"))
    ours.advance(3)
    ours.order("improvement")
    assert (ours.phase, ours.ordered) == ("evaluation", "improvement")
    assert ours.planning.endswith("; then improvement")
    ours.advance(FAR, 1)
    assert ours.phase == "evaluation"
    ours.advance(1)
    assert (ours.phase, ours.ordered) == ("improvement", None)
    ours.advance(FAR, 1)
    ours.advance(1)
    assert ours.phase == "evaluation"  # no further orders


def test_the_last_order_counts() -> None:
    ours = planner(shipped("frozenlake-slippery"))
    ours.order("improvement")
    assert ours.planning == ""
    assert sweep(ours, "evaluation") is Stop.DONE
    assert ours.planning == "policy 1, evaluation sweep 1: largest change 0.25"


def test_what_is_ordered_is_done_after_all_is_done() -> None:
    ours = planner(shipped("frozenlake-slippery"), Hyperparameters(gamma=0.9, accuracy=1e-12))
    assert ours.advance(FAR) is Stop.CONVERGED
    before = ours.q.copy()
    assert sweep(ours, "evaluation") is Stop.DONE
    assert sweep(ours, "improvement") is Stop.CONVERGED
    assert ours.q == pytest.approx(before, abs=1e-10)


def test_an_order_during_the_last_sweep_is_done_too() -> None:
    mdp = shipped("frozenlake-slippery")
    hyperparameters = Hyperparameters(gamma=0.9, accuracy=1e-12)
    steps = planner(mdp, hyperparameters)
    steps.advance(FAR)
    ours = planner(mdp, hyperparameters)
    ours.advance(steps.step - 1)
    ours.order("evaluation")
    assert ours.advance(FAR, 1) is Stop.DONE
    assert ours.advance(1) is Stop.DONE
    assert ours.phase == "evaluation"
    assert ours.advance(FAR) is Stop.CONVERGED


def test_the_policy_that_is_kept_changes_in_improvements_only() -> None:
    ours = planner(shipped("frozenlake"))
    for phase in ("evaluation", "evaluation", "improvement", "evaluation", "improvement"):
        (before,) = ours.remembered("policy")
        (values,) = ours.remembered("v")
        sweep(ours, phase)
        (policy,), (now,) = ours.remembered("policy"), ours.remembered("v")
        assert (policy.tobytes() == before.tobytes()) is (phase == "evaluation")
        assert (now.tobytes() == values.tobytes()) is (phase == "improvement")


def test_a_checkpoint_keeps_an_order() -> None:
    ours, other = planner(shipped("frozenlake-slippery")), planner(shipped("frozenlake-slippery"))
    ours.advance(5)
    ours.order("improvement")
    other.restore(ours.checkpoint())
    assert other.ordered == "improvement"
    for each in (ours, other):
        each.advance(40)
    assert ours.q.tobytes() == other.q.tobytes()


@pytest.mark.parametrize("algorithm", ["value-iteration", "q-learning"])
def test_only_policy_iteration_takes_orders(algorithm: str) -> None:
    ours = Learner(shipped("frozenlake-slippery"), algorithm, Hyperparameters(), streams(0))
    assert (ours.phase, ours.ordered) == (None, None)
    with pytest.raises(
        UserError, match="has no separate evaluation and improvement: choose policy-iteration"
    ):
        ours.order("evaluation")
