"""Algorithms that wait before they learn."""

from __future__ import annotations

import pytest

from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.kernels.position import Stop
from rl_tui.agents.last_step import LastStep
from rl_tui.agents.learner import Learner
from rl_tui.common.streams import streams
from rl_tui.worlds.mdp.tabular_mdp import Outcome, TabularMDP, Transition, tabular_mdp

CERTAIN = Hyperparameters(alpha=1.0, gamma=0.5, epsilon=0.0)


def corridor(length: int) -> TabularMDP:
    """One way only: the step out of state s pays s + 1."""
    names = [f"s{state}" for state in range(length + 1)]
    steps = [
        Transition(state, 0, [Outcome(1.0, state + 1, state + 1.0, state + 1 == length)])
        for state in range(length)
    ]
    return tabular_mdp(names, ["on"], steps, {0: 1.0})


def endless(time_limit: int = 0) -> TabularMDP:
    return tabular_mdp(
        ["here"], ["stay"], [Transition(0, 0, [Outcome(1.0, 0, 1.0, False)])], {0: 1.0}, time_limit
    )


def learner(mdp: TabularMDP, algorithm: str, **hyperparameters: object) -> Learner:
    parameters = CERTAIN
    for name, value in hyperparameters.items():
        parameters = parameters.changed(name, value)
    return Learner(mdp, algorithm, parameters, streams(0))


def after(ours: Learner, steps: int) -> LastStep:
    ours.advance(steps)
    last = ours.last_step
    assert last is not None
    return last


def test_n_steps_are_awaited_and_the_end_of_the_episode_brings_the_rest() -> None:
    ours = learner(corridor(4), "n-step-sarsa", n=3)
    assert not after(ours, 2).learned
    third = after(ours, 1)
    assert (third.updated_pair, third.gathered, third.discount, third.others) == (0, 2.75, 0.125, 0)
    last = after(ours, 1)
    assert (last.pair, last.updated_pair, last.after, last.others) == (3, 3, 4.0, 2)
    assert ours.q.tolist() == [2.75, 2.0 + 1.5 + 1.0, 3.0 + 2.0, 4.0]


def test_a_smaller_n_catches_up_and_a_greater_one_waits() -> None:
    ours = learner(corridor(10), "n-step-sarsa", n=5)
    assert not after(ours, 4).learned
    ours.configure(CERTAIN.changed("n", 2))
    caught_up = after(ours, 1)
    assert (caught_up.updated_pair, caught_up.others) == (3, 3)
    assert ours.q.tolist() == [2.0, 3.5, 5.0, 6.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    ours.configure(CERTAIN.changed("n", 4))
    assert [after(ours, 1).learned for _ in range(3)] == [False, False, True]
    assert ours.q[4] == 5.0 + 3.0 + 1.75 + 1.0
    assert (after(ours, 1).updated_pair, after(ours, 1).others) == (5, 3)
    assert ours.q[5:].tolist() == [6.0 + 3.5 + 2.0 + 1.125, 14.5, 15.0, 14.0, 10.0]


def test_the_greatest_n_fits() -> None:
    ours = learner(corridor(1_200), "n-step-sarsa", n=1_000, gamma=1.0)
    assert not after(ours, 999).learned
    assert after(ours, 1).after == 1_000 * 1_001 / 2
    assert after(ours, 200).others == 999
    assert ours.q[0] == 1_000 * 1_001 / 2
    assert ours.q[1_199] == 1_200.0


def test_a_walk_back_tells_the_return_of_the_whole_episode() -> None:
    ours = learner(corridor(3), "monte-carlo")
    assert not after(ours, 2).learned
    last = after(ours, 1)
    assert ours.q.tolist() == [1.0 + 0.5 * 3.5, 2.0 + 1.5, 3.0]
    assert (last.updated_pair, last.target, last.after, last.bootstrap, last.others) == (
        0,
        2.75,
        2.75,
        0.0,
        2,
    )


def test_an_episode_cut_short_is_worth_what_would_have_followed() -> None:
    ours = learner(endless(time_limit=2), "monte-carlo", initial_q=8.0)
    last = after(ours, 2)
    assert (last.gathered, last.discount, last.bootstrap, last.others) == (1.5, 0.25, 8.0, 1)
    assert (last.before, last.after) == (1.0 + 0.5 * 8.0, 1.5 + 0.25 * 8.0)


@pytest.mark.exhaustive("takes an episode of ten million steps")
def test_an_episode_longer_than_the_memory_stops_the_run_and_says_so() -> None:
    ours = learner(endless(), "monte-carlo")
    assert ours.advance(10**7) is Stop.MEMORY_FULL
    assert ours.step == 10**6
    assert "remembers 1,000,000 steps" in ours.stop_reason
    assert ours.advance(1) is Stop.MEMORY_FULL
    assert ours.step == 10**6


def test_what_another_algorithm_learned_counts_on() -> None:
    for algorithm in ("n-step-sarsa", "monte-carlo", "double-q-learning"):
        ours = learner(corridor(1), "q-learning", alpha="sample-average", n=1)
        ours.advance(3)
        ours.switch(algorithm)
        assert after(ours, 1).step_size == 1 / 4
