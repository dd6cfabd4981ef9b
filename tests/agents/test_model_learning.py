from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rl_tui.agents.algorithms import dyna_q, prioritized_sweeping
from rl_tui.agents.algorithms.shared.priority_queue import dequeue, empty_queue, enqueue
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.learner import Learner
from rl_tui.common.streams import streams
from rl_tui.worlds.mdp.tabular_mdp import Outcome, TabularMDP, Transition, tabular_mdp


def corridor(length: int, reward: float = 1.0, time_limit: int = 0) -> TabularMDP:
    transitions = [
        Transition(state, 0, [Outcome(1.0, state + 1, reward * (state == length - 1), False)])
        for state in range(length)
    ]
    return tabular_mdp([str(each) for each in range(length + 1)], ["go"], transitions, {0: 1.0}, time_limit)


def coin(actions: int) -> TabularMDP:
    outcomes = [Outcome(0.5, 0, 1.0, False), Outcome(0.5, 1, 2.0, True)]
    transitions = [Transition(0, action, outcomes) for action in range(actions)]
    return tabular_mdp(["here", "end"], [str(each) for each in range(actions)], transitions, {0: 1.0})


def learner(mdp: TabularMDP, algorithm: str, **hyperparameters: object) -> Learner:
    return Learner(mdp, algorithm, Hyperparameters(**hyperparameters), streams(0))  # type: ignore[arg-type]


def dyna_memory(ours: Learner) -> dyna_q.Memory:
    return dyna_q.Memory(*ours.checkpoint().memory)


def sweeping_memory(ours: Learner) -> prioritized_sweeping.Memory:
    return prioritized_sweeping.Memory(*ours.checkpoint().memory)


@pytest.mark.parametrize("algorithm", ["dyna-q", "prioritized-sweeping"])
def test_the_model_holds_what_was_observed_last(algorithm: str) -> None:
    ours = learner(coin(2), algorithm, epsilon=1.0)
    expected = {}
    for _ in range(50):
        ours.advance(1)
        last = ours.last_step
        expected[last.pair] = (last.reward, -2 if last.terminated else last.next_state)
        _, _, rewards, next_states, *_ = ours.checkpoint().memory
        model = {pair: (rewards[pair], next_states[pair]) for pair in range(2) if next_states[pair] != -1}
        assert model == expected
    assert len(expected) == 2


def test_dyna_lists_each_state_and_action_once_in_the_order_of_their_first_time() -> None:
    ours = learner(corridor(3), "dyna-q")
    ours.advance(5)
    memory = dyna_memory(ours)
    assert memory.observed[: memory.observed_count[0]].tolist() == [0, 1, 2]
    assert memory.tried.tolist() == [0, 1, 2]
    assert memory.tried_count.tolist() == [1, 1, 1, 0]


def test_without_planning_steps_dyna_is_q_learning() -> None:
    dyna, plain = (learner(coin(3), name, planning_steps=0) for name in ("dyna-q", "q-learning"))
    for ours in (dyna, plain):
        ours.advance(500)
    assert dyna.q.tolist() == plain.q.tolist()
    assert dyna.last_step == plain.last_step


def test_dyna_practises_the_states_alike_and_then_the_actions() -> None:
    """One state has four actions and the other one: each gets half of the practice."""
    four = [Transition(0, action, [Outcome(1.0, 1, 0.0, False)]) for action in range(4)]
    mdp = tabular_mdp(
        ["a", "b", "c"], list("0123"), [*four, Transition(1, 0, [Outcome(1.0, 2, 1.0, False)])], {0: 1.0}
    )
    hyperparameters = Hyperparameters(alpha=1e-4, gamma=0.0, epsilon=1.0, planning_steps=0)
    ours = Learner(mdp, "dyna-q", hyperparameters, streams(0))
    ours.advance(100)
    before = ours.q[4]
    ours.configure(replace(hyperparameters, planning_steps=10_000))
    ours.advance(1)
    practised = np.log((1.0 - ours.q[4]) / (1.0 - before)) / np.log(1.0 - 1e-4)
    assert practised == pytest.approx(5_000, abs=200)
    assert ours.visits.sum() == 101


def test_one_pass_through_a_corridor_is_enough_for_prioritized_sweeping() -> None:
    ours = learner(corridor(5), "prioritized-sweeping", alpha=1.0, gamma=0.5, planning_steps=5, threshold=0.0)
    ours.advance(4)
    assert not ours.last_step.learned
    ours.advance(1)
    assert ours.q.tolist() == [0.0625, 0.125, 0.25, 0.5, 1.0]
    last = ours.last_step
    assert (last.updated_pair, last.before, last.target, last.after, last.others) == (4, 0.0, 1.0, 1.0, 4)


def test_planning_steps_and_threshold_say_how_far_it_sweeps() -> None:
    few = learner(corridor(5), "prioritized-sweeping", alpha=1.0, gamma=0.5, planning_steps=2, threshold=0.0)
    few.advance(5)
    assert few.q.tolist() == [0.0, 0.0, 0.0, 0.5, 1.0]
    few.advance(1)
    assert few.q.tolist() == [0.0, 0.125, 0.25, 0.5, 1.0]  # the queue outlives the episode
    coarse = learner(
        corridor(5), "prioritized-sweeping", alpha=1.0, gamma=0.5, planning_steps=9, threshold=0.25
    )
    coarse.advance(5)
    assert coarse.q.tolist() == [0.0, 0.0, 0.0, 0.5, 1.0]


def test_without_planning_steps_prioritized_sweeping_learns_nothing() -> None:
    ours = learner(corridor(3), "prioritized-sweeping", planning_steps=0)
    ours.advance(30)
    assert ours.q.tolist() == [0.0] * 3
    assert ours.visits.tolist() == [10] * 3


def test_every_state_knows_the_pairs_that_lead_to_it() -> None:
    ours = learner(coin(4), "prioritized-sweeping", epsilon=1.0)
    for _ in range(60):
        ours.advance(1)
        memory = sweeping_memory(ours)
        leading, pair, behind = set(), memory.leading[0], -1
        while pair >= 0:
            assert memory.link_previous[pair] == behind
            leading.add(int(pair))
            behind, pair = pair, memory.link_next[pair]
        assert leading == set(np.flatnonzero(memory.model_next == 0).tolist())


PRIORITIES = st.sampled_from([0.5, 1.0, 1.5, 2.0])


@given(st.lists(st.tuples(st.integers(0, 9), PRIORITIES) | st.none(), max_size=60))
@settings(max_examples=200, deadline=None)
def test_the_queue_gives_the_highest_priority_first_and_of_equal_ones_the_lower_number(
    commands: list[tuple[int, float] | None],
) -> None:
    queue, plain = empty_queue(10), dict[int, float]()
    for command in commands:
        if command is not None:
            pair, priority = command
            enqueue(queue, pair, priority)
            plain[pair] = max(priority, plain.get(pair, 0.0))
        elif plain:
            expected = min(plain, key=lambda each: (-plain[each], each))
            assert dequeue(queue) == expected
            del plain[expected]
        assert set(queue.heap[: queue.size[0]].tolist()) == set(plain)
        assert np.flatnonzero(queue.place >= 0).tolist() == sorted(plain)
