"""A person acts, and the same learner learns from it."""

from __future__ import annotations

import numpy as np
import pytest
from test_environment_loop import HYPERPARAMETERS, Line, Table, facts, lake, untabled
from test_every_algorithm import everything, learner

from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.kernels.position import Stop
from rl_tui.agents.kernels.watch import WatchedEvents, Watching
from rl_tui.agents.last_step import LastStep
from rl_tui.agents.learner import Learner
from rl_tui.common.errors import UserError
from rl_tui.common.streams import streams
from rl_tui.worlds.environment import StepResult
from rl_tui.worlds.mdp.space import all_pairs
from rl_tui.worlds.mdp.tabular_mdp import Outcome, TabularMDP, Transition, tabular_mdp

FULL_STEP = Hyperparameters(alpha=1.0, gamma=1.0, epsilon=0.0, lambda_=1.0, ties="first")
ON, JUMP = 1, 2  # the pairs of the middle state of two_ways


def two_ways() -> TabularMDP:
    """From s0 to s1, then to s2 for 0 or by a jump to the end for 1. The way out of s2 also gives 1."""
    return tabular_mdp(
        ["s0", "s1", "s2", "end"],
        ["on", "jump"],
        [
            Transition(0, 0, [Outcome(1.0, 1, 0.0, False)]),
            Transition(1, 0, [Outcome(1.0, 2, 0.0, False)]),
            Transition(1, 1, [Outcome(1.0, 3, 1.0, True)]),
            Transition(2, 0, [Outcome(1.0, 3, 1.0, True)]),
        ],
        {0: 1.0},
    )


def last_of(ours: Learner) -> LastStep:
    assert ours.last_step is not None
    return ours.last_step


@pytest.mark.parametrize("algorithm", ["q-learning"])
def test_q_learning_learns_from_it_as_from_its_own_and_the_choice_draws_nothing(algorithm: str) -> None:
    mdp, dice = lake(), np.random.default_rng(3)
    ours = learner(mdp, algorithm, HYPERPARAMETERS, 5)
    q, drawn = np.full(mdp.pairs, HYPERPARAMETERS.initial_q), ours.streams.learner.bit_generator.state
    for _ in range(300):
        pair = int(dice.choice(mdp.pairs_of(ours.state)))
        assert ours.take(pair) is Stop.DONE
        last = last_of(ours)
        assert (last.pair, last.by_hand, last.explored) == (pair, True, False)
        there = [q[each] for each in mdp.pairs_of(last.next_state)]
        bootstrap = 0.0 if last.terminated else max(there)
        q[pair] += 0.3 * (last.reward + HYPERPARAMETERS.gamma * bootstrap - q[pair])
    assert ours.q.tolist() == q.tolist()
    assert ours.streams.learner.bit_generator.state == drawn
    assert ours.visits.sum() == 300
    assert ours.episodes > 10


@pytest.mark.parametrize("algorithm", ["q-learning"])
def test_the_agent_goes_on_by_itself(algorithm: str) -> None:
    ours = learner(lake(), algorithm, HYPERPARAMETERS)
    ours.take(ours.space.pairs_of(ours.state)[1])
    ours.advance(50)
    assert not last_of(ours).by_hand


@pytest.mark.parametrize(
    "algorithm",
    [
        *("q-learning", "sarsa", "expected-sarsa", "monte-carlo", "n-step-sarsa", "sarsa-lambda"),
        "q-lambda",
        "prioritized-sweeping",
    ],
)
def test_what_the_agent_would_have_done_teaches_the_same_by_hand(algorithm: str) -> None:
    hyperparameters = Hyperparameters(alpha=0.5, epsilon=0.0, ties="first", initial_q=0.5)
    agent, hand = (learner(lake(), algorithm, hyperparameters, 2) for _ in range(2))
    for _ in range(200):
        agent.advance(1)
        hand.take(last_of(agent).pair)
    assert hand.q.tolist() == agent.q.tolist()
    assert hand.visits.tolist() == agent.visits.tolist()


@pytest.mark.parametrize("algorithm", ["sarsa"])
def test_what_sarsa_had_chosen_is_dropped(algorithm: str) -> None:
    ours = learner(two_ways(), algorithm, FULL_STEP)
    ours.q[ON] = 0.5
    ours.advance(1)
    assert ours.q.tolist() == [0.5, 0.5, 0.0, 0.0]  # it chose to go on
    ours.take(JUMP)
    assert ours.q.tolist() == [0.5, 0.5, 1.0, 0.0]
    ours.advance(1)
    assert (last_of(ours).pair, ours.q[0]) == (0, 1.0)  # and now it chooses to jump


@pytest.mark.parametrize(
    ("algorithm", "on", "q"),
    [
        ("n-step-sarsa", 0.5, [1.0, 0.5, 1.0, 0.0]),  # it remembers what was really taken
        ("q-lambda", 0.5, [0.5, 0.5, 1.0, 0.0]),  # no trace leads beyond an action that is not greedy
        ("q-lambda", 0.0, [1.0, 0.0, 1.0, 0.0]),  # as good as continuing, by current estimates
        ("sarsa-lambda", 0.5, [1.5, 0.5, 1.0, 0.0]),  # a trace leads beyond whatever is done
    ],
)
def test_a_jump_by_hand_teaches_the_step_before_it(algorithm: str, on: float, q: list[float]) -> None:
    ours = learner(two_ways(), algorithm, FULL_STEP.changed("n", 2))
    ours.q[ON] = on
    ours.advance(1)
    ours.take(JUMP)
    assert ours.q.tolist() == q
    assert ours.visits.tolist() == [1, 0, 1, 0]
    assert last_of(ours).others == (q[0] != 0.5)


@pytest.mark.exhaustive("compiles loops", but=["q-learning"])
@pytest.mark.parametrize("algorithm", ["q-learning", "sarsa", "q-lambda"])
def test_a_stepped_environment_is_acted_in_alike(algorithm: str) -> None:
    mdp = lake()
    by_table = Learner(mdp, algorithm, HYPERPARAMETERS, streams(7))
    stepped = Learner(untabled(mdp), algorithm, HYPERPARAMETERS, streams(7), Table(mdp, 7))
    dice = np.random.default_rng(1)
    for turn in range(200):
        pair = int(dice.choice(mdp.pairs_of(by_table.state)))
        for ours in (by_table, stepped):
            ours.take(pair)
            ours.advance(turn % 3)
            ours.drain_episodes()
    assert facts(stepped) == facts(by_table)


def test_a_failure_of_the_environment_leaves_the_choice_to_nobody() -> None:
    space = all_pairs(["here"], ["on"], 0)
    ours = Learner(
        space, "q-learning", HYPERPARAMETERS, streams(0), Line(StepResult(0, 1.0, False, False), None)
    )
    assert ours.take(0) is Stop.DONE
    assert ours.take(0) is Stop.WORLD_FAILED
    assert (ours.step, ours._position.forced[0]) == (1, -1)


@pytest.mark.parametrize("algorithm", ["q-lambda"])
def test_a_step_by_hand_is_watched_and_comes_back_from_a_checkpoint(algorithm: str) -> None:
    ours = learner(two_ways(), algorithm, FULL_STEP)
    ours.advance(1)
    kept = ours.checkpoint()
    ours.watch(Watching(pairs=frozenset({JUMP})))
    assert ours.take(JUMP) is Stop.NOTICED
    assert ours.noticed == WatchedEvents(pair=JUMP)
    ours.drain_episodes()
    expected = everything(ours)
    ours.advance(7)
    ours.restore(kept)
    ours.take(JUMP)
    ours.drain_episodes()
    assert everything(ours) == expected


@pytest.mark.parametrize("algorithm", ["sarsa"])
def test_an_action_of_another_state_cannot_be_taken(algorithm: str) -> None:
    ours = learner(two_ways(), algorithm, FULL_STEP)
    ours.advance(1)
    for pair in (0, 3, -1, 99):
        with pytest.raises(UserError, match="not available in state s1: choose one of on, jump"):
            ours.take(pair)
    assert ours.step == 1


def test_nobody_acts_for_a_planner() -> None:
    ours = learner(two_ways(), "value-iteration", FULL_STEP)
    with pytest.raises(UserError, match="Value iteration is a planner and takes no steps: to act yourself"):
        ours.take(0)
