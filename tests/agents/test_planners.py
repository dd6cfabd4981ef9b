from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from plain_policy_iteration import plain_policy_iteration
from plain_value_iteration import plain_value_iteration
from random_worlds import worlds

from rl_tui.agents.algorithms.policy_iteration import Memory, phase_of
from rl_tui.agents.catalogue import BY_ID
from rl_tui.agents.exact.solve import solve
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.kernels.position import Stop
from rl_tui.agents.learner import Learner
from rl_tui.common.streams import streams
from rl_tui.worlds.files.catalogue import find
from rl_tui.worlds.mdp.tabular_mdp import Outcome, TabularMDP, Transition, tabular_mdp

PLANNERS = [each.id for each in BY_ID.values() if each.planner]
PLAIN: dict[str, Callable[..., tuple[dict[int, float], int, bool]]] = {
    "value-iteration": plain_value_iteration,
    "policy-iteration": plain_policy_iteration,
}
both = pytest.mark.parametrize("algorithm", PLANNERS)

any_hyperparameters = st.builds(
    Hyperparameters,
    gamma=st.sampled_from([0.0, 0.5, 0.9]),
    accuracy=st.sampled_from([1e-9, 0.01, 1.0]),
    initial_q=st.sampled_from([0.0, 2.5]),
    ties=st.sampled_from(["random", "first"]),
)


def learner(mdp: TabularMDP, algorithm: str, hyperparameters: Hyperparameters | None = None) -> Learner:
    return Learner(mdp, algorithm, hyperparameters or Hyperparameters(), streams(0))


def shipped(name: str) -> TabularMDP:
    mdp = find(name).build(streams(0).world).mdp
    assert mdp is not None
    return mdp


def row(rewards: list[float], time_limit: int = 0) -> TabularMDP:
    """A step right, towards the end, pays its state's reward; staying pays nothing."""
    transitions = []
    for state, reward in enumerate(rewards):
        transitions.append(Transition(state, 0, [Outcome(1.0, state, 0.0, False)]))
        transitions.append(Transition(state, 1, [Outcome(1.0, state + 1, reward, False)]))
    names = [f"s{state}" for state in range(len(rewards) + 1)]
    return tabular_mdp(names, ["stay", "right"], transitions, {0: 1.0}, time_limit)


@both
@given(mdp=worlds(), hyperparameters=any_hyperparameters, steps=st.integers(0, 400))
@settings(max_examples=40, deadline=None)
def test_it_does_what_the_box_says(
    algorithm: str, mdp: TabularMDP, hyperparameters: Hyperparameters, steps: int
) -> None:
    ours = learner(mdp, algorithm, hyperparameters)
    ours.advance(steps)
    q, taken, done = PLAIN[algorithm](mdp, hyperparameters, steps)
    assert (ours.q.tolist(), ours.step) == (list(q.values()), taken)
    assert ours.converged or not done
    states = [state for state in range(mdp.states) if mdp.pairs_of(state)]
    backed_up = [states[step % len(states)] for step in range(taken)]
    assert ours.visits.tolist() == [backed_up.count(mdp.state_of(pair)) for pair in range(mdp.pairs)]


@both
@given(mdp=worlds(), gamma=st.sampled_from([0.0, 0.5, 0.9]), ties=st.sampled_from(["random", "first"]))
@settings(max_examples=40, deadline=None)
def test_it_finds_the_exact_answer(algorithm: str, mdp: TabularMDP, gamma: float, ties: str) -> None:
    hyperparameters = replace(Hyperparameters(gamma=gamma, accuracy=1e-12, initial_q=1.0), ties=ties)
    ours = learner(mdp, algorithm, hyperparameters)
    assert ours.advance(10**6) is Stop.CONVERGED
    assert ours.q == pytest.approx(solve(mdp, gamma).q, abs=1e-8)


@pytest.mark.exhaustive(
    "solves large lakes",
    but=[
        "random-frozenlake-slippery-0.99-value-iteration",
        "random-frozenlake-slippery-0.99-policy-iteration",
    ],
)
@both
@pytest.mark.parametrize("gamma", [0.99, 1.0])
@pytest.mark.parametrize("name", ["frozenlake", "frozenlake-slippery", "frozenlake-8x8-slippery"])
@pytest.mark.parametrize("ties", ["random", "first"])
def test_it_solves_the_lakes(algorithm: str, name: str, gamma: float, ties: str) -> None:
    hyperparameters = replace(Hyperparameters(gamma=gamma, accuracy=1e-13), ties=ties)
    ours = learner(shipped(name), algorithm, hyperparameters)
    assert ours.advance(10**7) is Stop.CONVERGED
    assert ours.q == pytest.approx(solve(shipped(name), gamma).q, abs=1e-8)


def test_a_step_is_the_backup_of_a_state_and_an_episode_a_sweep() -> None:
    ours = learner(row([1.0, 2.0, 4.0]), "value-iteration", Hyperparameters(gamma=0.5))
    seen = []
    for _ in range(4):
        ours.advance(1)
        assert ours.last_step.planned
        seen.append((ours.last_step.state, ours.last_step.episode, ours.episodes, ours.episode_step))
    assert seen == [(0, 1, 0, 1), (1, 1, 0, 2), (2, 1, 1, 0), (0, 2, 1, 1)]
    assert ours.state == 1
    ours.advance(10**6, episodes=1)
    assert (ours.episodes, ours.state, ours.step) == (2, 0, 6)
    assert ours.drain_episodes().returns.tolist() == []


def test_the_record_explains_the_best_pair() -> None:
    ours = learner(row([1.0, 2.0]), "value-iteration", Hyperparameters(gamma=0.5, initial_q=3.0))
    ours.advance(1)
    last = ours.last_step
    assert (last.updated_pair, last.before, last.gathered, last.bootstrap, last.after) == (
        1,
        3.0,
        1.0,
        3.0,
        2.5,
    )
    assert (last.step_size, last.discount, last.others) == (1.0, 0.5, 1)
    assert last.after == last.before + last.step_size * last.td_error


def test_value_iteration_goes_backwards_a_state_a_sweep() -> None:
    ours = learner(row([0.0, 0.0, 1.0]), "value-iteration", Hyperparameters(gamma=0.5))
    values = []
    while not ours.converged:
        ours.advance(10, episodes=1)
        values.append(ours.q[1::2].tolist())
    assert values == [[0.0, 0.0, 1.0], [0.0, 0.5, 1.0], [0.25, 0.5, 1.0], [0.25, 0.5, 1.0]]


def phase(ours: Learner) -> str:
    return phase_of(Memory(*ours.checkpoint().memory))


def test_policy_iteration_evaluates_the_equal_policy_then_improves_it() -> None:
    ours = learner(row([1.0]), "policy-iteration", Hyperparameters(gamma=0.5, accuracy=1e-12))
    assert ours.planning == ""
    ours.advance(1)
    assert (phase(ours), ours.planning) == ("evaluation", "policy 1, evaluation sweep 1: largest change 0.5")
    while phase(ours) == "evaluation":
        ours.advance(1)
    assert ours.q == pytest.approx([1 / 3, 1.0])
    assert ours.planning == "policy 1, improvement: 1 state changed"
    assert ours.advance(10**6) is Stop.CONVERGED
    assert ours.planning == "policy 2, improvement: 0 states changed"
    assert ours.q == pytest.approx([0.5, 1.0])


def test_the_record_of_an_evaluation_is_of_the_pair_that_the_policy_takes() -> None:
    ours = learner(row([-1.0]), "policy-iteration", Hyperparameters(gamma=0.5))
    assert ours.advance(10**6) is Stop.CONVERGED
    assert (ours.last_step.state, ours.last_step.updated_pair) == (0, 0)


def test_value_iteration_says_how_far_it_is() -> None:
    ours = learner(row([1.0]), "value-iteration", Hyperparameters(gamma=0.5))
    assert ours.planning == ""
    ours.advance(1)
    assert ours.planning == "sweep 1: largest change 1"
    ours.switch("q-learning")
    assert ours.planning == ""


@both
@pytest.mark.parametrize("ties", ["random", "first"])
def test_without_discount_it_prefers_a_policy_that_ends(algorithm: str, ties: str) -> None:
    """Staying and going both pay nothing."""
    ours = learner(row([0.0, 0.0, 1.0]), algorithm, replace(Hyperparameters(gamma=1.0), ties=ties))
    assert ours.advance(10**6) is Stop.CONVERGED
    assert ours.q == pytest.approx([1.0] * 5 + [1.0], abs=1e-6)


@both
def test_without_discount_and_without_an_end_it_goes_on_for_ever(algorithm: str) -> None:
    mdp = tabular_mdp(["here"], ["stay"], [Transition(0, 0, [Outcome(1.0, 0, -1.0, False)])], {0: 1.0})
    ours = learner(mdp, algorithm, Hyperparameters(gamma=1.0))
    assert ours.advance(1000) is Stop.DONE
    assert ours.q.tolist() == [-1000.0]
    ours.configure(Hyperparameters(gamma=0.5))
    assert ours.advance(1000) is Stop.CONVERGED
    assert ours.q == pytest.approx([-2.0])


@both
def test_a_runaway_stops_and_says_what_helps(algorithm: str) -> None:
    mdp = tabular_mdp(["here"], ["stay"], [Transition(0, 0, [Outcome(1.0, 0, 1e11, False)])], {0: 1.0})
    ours = learner(mdp, algorithm, Hyperparameters(gamma=1.0))
    assert ours.advance(1000) is Stop.DIVERGED
    assert ours.stop_reason == "Q(here, stay) left ±1e12 at step 11: take a smaller discount or start again"


@both
def test_a_new_discount_lets_it_go_on_whenever_it_comes(algorithm: str) -> None:
    mdp = shipped("frozenlake-slippery")
    hyperparameters = Hyperparameters(gamma=0.5, accuracy=1e-12)
    ours = learner(mdp, algorithm, hyperparameters)
    for gamma, steps in ((0.5, 10**6), (0.9, 3), (0.8, 10**6), (0.8, 10**6), (0.7, 40), (0.9, 10**6)):
        ours.configure(replace(hyperparameters, gamma=gamma))
        ours.advance(steps)
        if steps == 10**6:
            assert ours.converged
            assert ours.q == pytest.approx(solve(mdp, gamma).q, abs=1e-8)


@both
def test_the_time_limit_plays_no_part(algorithm: str) -> None:
    limited, unlimited = (learner(row([1.0, 2.0], limit), algorithm) for limit in (1, 0))
    for ours in (limited, unlimited):
        ours.advance(10**6)
    assert limited.q.tolist() == unlimited.q.tolist()
    assert limited.step == unlimited.step


@both
def test_to_a_planner_and_back_in_mid_episode(algorithm: str) -> None:
    hyperparameters = Hyperparameters(epsilon=1.0)
    ours = learner(row([0.0, 5.0, 1.0]), "q-learning", hyperparameters)
    while ours.state != 2:
        ours.advance(1)
    ours.drain_episodes()
    q, visits = ours.q.copy(), ours.visits.copy()
    ours.switch(algorithm)
    assert (ours.q.tolist(), ours.visits.tolist()) == (q.tolist(), visits.tolist())
    assert (ours.state, ours.episode_step, ours.counters.episode_return) == (0, 0, 0.0)
    step, episodes = ours.step, ours.episodes
    ours.advance(4)
    assert (ours.step, ours.episodes, ours.state, ours.episode_step) == (step + 4, episodes + 1, 1, 1)
    assert (ours.visits - visits).tolist() == [2, 2, 1, 1, 1, 1]
    ours.switch("q-learning")
    assert (ours.state, ours.episode_step, ours.counters.episode_return) == (0, 0, 0.0)
    ours.advance(10**6, episodes=1)
    episode = ours.drain_episodes()
    assert episode.returns.tolist() == [6.0]
    assert episode.lengths.tolist() == [ours.step - step - 4]
    assert ours.episodes == episodes + 2


def test_from_a_planner_to_another_a_sweep_begins() -> None:
    ours = learner(row([1.0, 2.0]), "value-iteration", Hyperparameters(gamma=0.5))
    ours.advance(3)
    ours.switch("policy-iteration")
    assert (ours.state, ours.episode_step) == (0, 0)
    assert ours.advance(10**6) is Stop.CONVERGED
    assert ours.q == pytest.approx([1.0, 2.0, 1.0, 2.0])


@both
def test_states_without_pairs_are_left_out(algorithm: str) -> None:
    """The end and a state that cannot be reached come first."""
    mdp = tabular_mdp(
        ["end", "nowhere", "a", "b"],
        ["go"],
        [
            Transition(1, 0, [Outcome(1.0, 0, 9.0, False)]),
            Transition(2, 0, [Outcome(1.0, 3, 1.0, False)]),
            Transition(3, 0, [Outcome(1.0, 0, 1.0, False)]),
        ],
        {2: 1.0},
    )
    ours = learner(mdp, algorithm, Hyperparameters(gamma=1.0))
    seen = [ours.state]
    for _ in range(3):
        ours.advance(1)
        seen.append(ours.state)
    assert seen == [2, 3, 2, 3]


def test_a_planner_knows_rewards_where_they_have_drifted_to() -> None:
    arms = [Transition(0, arm, [Outcome(1.0, 0, 0.0, True)]) for arm in range(3)]
    still = tabular_mdp(["here"], ["a", "b", "c"], arms, {0: 1.0})
    ours = learner(replace(still, drift_std=1.0), "q-learning")
    ours.advance(100)
    ours.switch("value-iteration")
    assert ours.advance(100) is Stop.CONVERGED
    assert ours.q.tolist() == ours.mdp.reward.tolist()
    assert ours.q.tolist() != [0.0] * 3
