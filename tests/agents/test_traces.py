from __future__ import annotations

import numpy as np
import pytest
from test_model_learning import corridor, learner

from rl_tui.agents.learner import Learner
from rl_tui.worlds.mdp.tabular_mdp import Outcome, TabularMDP, Transition, tabular_mdp

TRACED = ("sarsa-lambda", "q-lambda")
both = pytest.mark.parametrize("algorithm", TRACED)


def circle(rewards: list[float], time_limit: int) -> TabularMDP:
    transitions = [
        Transition(state, 0, [Outcome(1.0, (state + 1) % len(rewards), reward, False)])
        for state, reward in enumerate(rewards)
    ]
    return tabular_mdp([str(each) for each in range(len(rewards))], ["go"], transitions, {0: 1.0}, time_limit)


def traces(ours: Learner) -> list[float]:
    eligibility: np.ndarray = ours.checkpoint().memory[2]
    return eligibility.tolist()


@both
def test_one_step_teaches_all_that_led_to_it(algorithm: str) -> None:
    ours = learner(corridor(3), algorithm, alpha=0.5, gamma=1.0, lambda_=0.5)
    ours.advance(2)
    assert ours.q.tolist() == [0.0, 0.0, 0.0]
    assert traces(ours) == [0.25, 0.5, 0.0]
    ours.advance(1)
    assert ours.q.tolist() == [0.125, 0.25, 0.5]
    assert traces(ours) == [0.0, 0.0, 0.0]
    last = ours.last_step
    assert (last.updated_pair, last.others, last.step_size, last.after) == (2, 2, 0.5, 0.5)


@both
def test_without_trace_decay_it_is_the_one_step_method(algorithm: str) -> None:
    ours = learner(corridor(3), algorithm, alpha=0.5, gamma=1.0, lambda_=0.0)
    ours.advance(3)
    assert ours.q.tolist() == [0.0, 0.0, 0.5]
    ours.advance(3)
    assert ours.q.tolist() == [0.0, 0.25, 0.75]
    assert ours.last_step.others == 0


@both
@pytest.mark.parametrize(("kind", "trace"), [("replacing", 1.0), ("accumulating", 1.25)])
def test_a_second_visit(algorithm: str, kind: str, trace: float) -> None:
    ours = learner(circle([1.0, 0.0], 3), algorithm, alpha=0.5, gamma=0.5, lambda_=1.0, traces=kind)
    ours.advance(2)
    first, second = ours.q.tolist()
    assert (first, second) == (0.5 + 0.5 * 0.5 * 0.25, 0.5 * 0.25)
    assert traces(ours) == [0.25, 0.5]
    error = 1.0 + 0.5 * second - first
    ours.advance(1)
    assert ours.q.tolist() == [first + 0.5 * trace * error, second + 0.5 * 0.5 * error]
    assert ours.last_step.truncated
    assert ours.last_step.step_size == 0.5 * trace
    assert traces(ours) == [0.0, 0.0]


@both
def test_sample_averages_are_each_pairs_own(algorithm: str) -> None:
    ours = learner(corridor(2), algorithm, alpha="sample-average", gamma=1.0, lambda_=0.5)
    ours.advance(2)
    assert ours.q.tolist() == [0.5, 1.0]
    ours.advance(1)
    # The second visit of the first pair: δ = 1 − 0.5, step size 1/2
    assert ours.q.tolist() == [0.75, 1.0]
    ours.advance(1)
    assert ours.q.tolist() == [0.75, 1.0]


def fork(reward: float) -> TabularMDP:
    return tabular_mdp(
        ["start", "fork", "end"],
        ["left", "right"],
        [
            Transition(0, 0, [Outcome(1.0, 1, 0.0, False)]),
            Transition(1, 0, [Outcome(1.0, 2, reward, False)]),
            Transition(1, 1, [Outcome(1.0, 2, -1.0, False)]),
        ],
        {0: 1.0},
    )


@pytest.mark.parametrize(("algorithm", "cut"), [("q-lambda", True), ("sarsa-lambda", False)])
def test_only_watkins_cuts_traces_before_an_action_that_is_not_greedy(algorithm: str, cut: bool) -> None:
    ours = learner(fork(1.0), algorithm, alpha=0.5, gamma=1.0, lambda_=1.0, epsilon=1.0)
    chosen = set()
    for _ in range(40):
        ours.advance(1)
        greedy = ours.q[1:3] == ours.q[1:3].max()
        trace = traces(ours)[0]
        ours.advance(1)
        taken = ours.last_step.pair
        assert trace == (0.0 if cut and not greedy[taken - 1] else 1.0)
        assert ours.last_step.others == (trace > 0.0)
        chosen.add(taken)
    assert chosen == {1, 2}


def test_an_equally_good_action_is_greedy_even_where_it_was_drawn_to_explore() -> None:
    ours = learner(fork(-1.0), "q-lambda", alpha=1.0, gamma=1.0, lambda_=1.0, epsilon=1.0, initial_q=-1.0)
    for _ in range(20):
        ours.advance(1)
        assert traces(ours)[0] == 1.0
        ours.advance(1)


@both
def test_faded_traces_are_dropped(algorithm: str) -> None:
    ours = learner(corridor(100), algorithm, gamma=0.5, lambda_=0.5)
    ours.advance(90)
    kept = [trace for trace in traces(ours) if trace]
    assert kept == [0.25**age for age in range(19, 0, -1)]
    assert ours.last_step.others == 19


@both
def test_a_runaway_of_any_pair_is_noticed_and_named(algorithm: str) -> None:
    ours = learner(circle([1e9, 0.0], 0), algorithm, alpha=1.0, gamma=1.0, lambda_=1.0, traces="accumulating")
    ours.advance(100)
    worst = int(np.argmax(np.abs(ours.q)))
    assert ours.stop_reason.startswith(f"Q({worst}, go) left ±1e12 at step {ours.step}: ")


@both
def test_no_trace_is_left_after_a_switch(algorithm: str) -> None:
    ours = learner(corridor(3), algorithm, alpha=0.5, gamma=1.0, lambda_=0.5)
    ours.advance(2)
    ours.switch("q-learning")
    ours.switch(algorithm)
    ours.advance(1)
    assert ours.q.tolist() == [0.0, 0.0, 0.5]
