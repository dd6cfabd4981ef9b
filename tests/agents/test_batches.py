"""Runs in one call of machine code have the bits of single runs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from two_forms import examples, worlds_for

from rl_tui.agents.batches import seeding
from rl_tui.agents.batches.batch import DrawnWorld, RunBatch
from rl_tui.agents.batches.rows import row, stacked
from rl_tui.agents.batches.seeding import MOST_SEED, seed_streams, streams_of
from rl_tui.agents.compiling.loops import all_batches, compile_here
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.kernels.machine_code import Batching, Loop, interpreted, machine_code
from rl_tui.agents.kernels.parameters import kernel_parameters, schedules_of
from rl_tui.agents.kernels.position import Stop
from rl_tui.agents.learner import Learner
from rl_tui.common.streams import has_low_word_first, streams
from rl_tui.runs.library import find, recipe_for
from rl_tui.runs.recipe import begin
from rl_tui.worlds.mdp.tabular_mdp import Outcome, TabularMDP, Transition, tabular_mdp

# Each algorithm and each policy once: a batch has no code of its own for either
EVERYDAY = Loop("q-learning", "epsilon-greedy", stepped=False, batching=Batching.IN_TURN)
SOME_BATCHES = pytest.mark.parametrize(
    "loop",
    [
        pytest.param(loop, marks=() if loop == EVERYDAY else pytest.mark.exhaustive("compiles a batch"))
        for loop in all_batches()
        if loop.algorithm == "q-learning" or loop.policy == "epsilon-greedy"
    ],
    ids=lambda loop: f"{loop.algorithm}-{loop.policy}-{loop.batching}".replace(" ", "-"),
)


def test_every_agent_that_learns_in_a_table_has_a_batch() -> None:
    found = list(all_batches())
    assert len(found) == len(set(found))
    assert all(loop.batching and loop.policy and not loop.stepped for loop in found)


@given(st.lists(st.integers(0, MOST_SEED) | st.integers(MOST_SEED + 1, 2**70), min_size=1, max_size=5))
def test_streams_are_those_that_numpy_seeds(seeds: list[int]) -> None:
    memory, address = streams_of(seeds)
    for index, seed in enumerate(seeds):
        for stream, generator in enumerate(streams(seed)):
            words = [int(word) for word in memory[index, stream, :4]]
            state = generator.bit_generator.state["state"]
            assert words[0] | words[1] << 64 == state["state"]
            assert words[2] | words[3] << 64 == state["inc"]
            assert int(address[index, stream]) == memory[index, stream, 4:].ctypes.data
    assert memory.ctypes.data % 16 == 0


def test_where_numpy_keeps_the_high_word_first_so_do_we(monkeypatch: pytest.MonkeyPatch) -> None:
    seeds = [3, MOST_SEED + 5]
    as_here = streams_of(seeds)[0]
    monkeypatch.setattr(seeding, "has_low_word_first", lambda: not has_low_word_first())
    swapped = streams_of(seeds)[0]
    assert swapped[:, :, [1, 0, 3, 2]].tolist() == as_here[:, :, :4].tolist()


@pytest.mark.parametrize("form", [interpreted, machine_code])
def test_seeding_has_two_forms(form: Any) -> None:
    memory = np.zeros((3, 2, 6), np.uint64)
    form(seed_streams)(np.array([0, 7, MOST_SEED]), np.zeros(4, np.int64), np.zeros((3, 8), np.int64), memory)
    assert np.array_equal(memory[:, :, :4], streams_of([0, 7, MOST_SEED])[0][:, :, :4])


def test_a_row_of_a_stack_is_what_was_stacked() -> None:
    one, other = Hyperparameters(alpha=0.5), Hyperparameters(epsilon=0.3, epsilon_decay=0.1)
    parameters = stacked([kernel_parameters(one), kernel_parameters(other)], [1, 2])
    schedules = stacked([schedules_of(one), schedules_of(other)], [1, 2])
    for place, values in enumerate((one, other, other)):
        assert row(parameters, place) == kernel_parameters(values)
        assert row(schedules, place) == schedules_of(values)
    fixed = np.zeros(3)
    fixed.flags.writeable = False
    assert not stacked([(fixed,)], [2])[0].flags.writeable
    assert stacked([(np.zeros(3),)], [2])[0].flags.writeable


@st.composite
def maps(draw: st.DrawFn) -> TabularMDP:
    states = draw(st.integers(2, 6))
    generator = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    ends = {int(generator.integers(1, states))}
    transitions = []
    for state in set(range(states)) - ends:
        for action in range(4):
            targets = generator.integers(0, states, size=generator.integers(1, 4)).tolist()
            weights = generator.dirichlet(np.ones(len(targets))).tolist()
            outcomes = [
                Outcome(
                    weight,
                    target,
                    float(generator.integers(-2, 3)),
                    target in ends,
                    float(generator.integers(0, 2)),
                )
                for weight, target in zip(weights, targets, strict=True)
            ]
            transitions.append(Transition(state, action, outcomes))
    names = [f"s{state}" for state in range(states)]
    start = {0: 0.5, states - 1: 0.5} if draw(st.booleans()) and states - 1 not in ends else {0: 1.0}
    return tabular_mdp(names, ["a", "b", "c", "d"], transitions, start, draw(st.sampled_from([0, 1, 5, 50])))


def worlds_in(loop: Loop) -> st.SearchStrategy[TabularMDP]:
    return maps() if loop.batching is Batching.IN_TURN else worlds_for(loop._replace(batching=Batching.NONE))


def trained(batch: RunBatch, budget: int) -> RunBatch:
    while batch.advance(budget):
        pass
    return batch


def alone(
    mdp: TabularMDP, seed: int, algorithm: str, values: Hyperparameters, steps: int, episodes: int
) -> tuple[Learner, list[Any], Stop]:
    learner = Learner(mdp, algorithm, values, streams(seed))
    stop = learner.advance(steps, episodes)
    return learner, list(learner.drain_episodes()), stop


def assert_same(batch: RunBatch, index: int, learner: Learner, episodes: Sequence[Any]) -> None:
    returns, lengths, optimal = episodes
    assert batch.q[index].tobytes() == learner.q.tobytes()
    assert batch.visits[index].tobytes() == learner.visits.tobytes()
    assert (batch.steps[index], batch.episodes[index]) == (learner.step, learner.episodes)
    assert batch.first_reward_episode[index] == learner.first_reward_episode
    recent_returns, recent_lengths = batch.recent(index)
    assert sorted(recent_returns) == sorted(returns[-100:])
    assert sorted(recent_lengths) == sorted(lengths[-100:])
    mean_returns, mean_lengths = batch.recent_means()
    if len(returns):
        assert mean_returns[index] == math.fsum(returns[-100:]) / len(returns[-100:])
        assert mean_lengths[index] == math.fsum(lengths[-100:]) / len(lengths[-100:])
    total = 0.0
    for each in returns.tolist():
        total += each
    assert batch.digest.total_return[index, 0] == total
    curve = batch.digest.curve
    assert curve.lengths[index].sum() == lengths[:30].sum()
    assert curve.optimal[index].sum() == optimal[:30].sum()


@SOME_BATCHES
def test_each_run_is_that_of_a_learner(loop: Any) -> None:
    compile_here(loop)

    @examples(5)
    @given(worlds_in(loop), st.integers(0, 2**40), st.integers(1, 300))
    def check(mdp: TabularMDP, seed: int, budget: int) -> None:
        seeds = range(seed, seed + 6)
        for values, steps, episodes in (
            (Hyperparameters(policy=loop.policy, alpha=0.3, n=2, planning_steps=3), 200, 2**60),
            (Hyperparameters(policy=loop.policy, epsilon=0.4, epsilon_decay=0.01, ties="first"), 2_000, 40),
        ):
            batch = RunBatch(
                loop.algorithm, values, seeds, mdp, steps=steps, episodes=episodes, curve_episodes=30, width=7
            )
            trained(batch, budget)
            for index, each in enumerate(seeds):
                learner, finished, stop = alone(mdp, each, loop.algorithm, values, steps, episodes)
                assert_same(batch, index, learner, finished)
                assert (batch.stop[index] in (Stop.DONE, Stop.EPISODES_FULL)) == (stop is Stop.DONE)

    check()


def test_more_episodes_than_the_log_holds_and_worlds_of_their_own() -> None:
    compile_here(EVERYDAY._replace(batching=Batching.ONE_BY_ONE))
    recipes = [recipe_for(find("bandit"), seed=seed) for seed in range(3)]
    beginnings = [begin(recipe) for recipe in recipes]
    worlds = [DrawnWorld(each.world.mdp, each.streams) for each in beginnings]  # type: ignore[arg-type]
    values = recipes[0].hyperparameters
    batch = trained(
        RunBatch("q-learning", values, range(3), worlds, episodes=5_000, curve_episodes=30), 1_000
    )
    for index, recipe in enumerate(recipes):
        beginning = begin(recipe)
        mdp = beginning.world.mdp
        assert mdp is not None
        learner = Learner(mdp, "q-learning", recipe.hyperparameters, beginning.streams)
        learner.advance(2**60, 5_000)
        assert_same(batch, index, learner, learner.drain_episodes())


def test_estimates_are_kept_at_the_marks() -> None:
    mdp = begin(recipe_for(find("frozenlake-slippery"))).world.mdp
    assert mdp is not None
    compile_here(Loop("q-learning", "epsilon-greedy", stepped=False, batching=Batching.IN_TURN))
    values, marks = Hyperparameters(), (1, 2, 20, 50)
    batch = trained(RunBatch("q-learning", values, (3, 4), mdp, episodes=50, mark_episodes=marks), 333)
    for index, seed in enumerate((3, 4)):
        learner = Learner(mdp, "q-learning", values, streams(seed))
        for place, until in enumerate(marks):
            learner.advance(2**60, until - learner.episodes)
            assert batch.mark_estimates[index, place].tobytes() == learner.q.tobytes()
    assert batch.marks_passed.tolist() == [4, 4]


def test_a_run_that_breaks_down_does_not_hold_up_the_others() -> None:
    # One start leads to rewards that grow without bounds, the other to nothing
    pays = [Outcome(1.0, 0, 1e11, False)]
    ends = [Outcome(1.0, 2, 0.0, True)]
    transitions = [
        Transition(state, action, pays if state == 0 else ends) for state in (0, 1) for action in range(4)
    ]
    names = ["rich", "poor", "end"]
    mdp = tabular_mdp(names, ["a", "b", "c", "d"], transitions, {0: 0.5, 1: 0.5}, time_limit=50)
    compile_here(Loop("q-learning", "epsilon-greedy", stepped=False, batching=Batching.IN_TURN))
    values, seeds = Hyperparameters(gamma=1.0, alpha=1.0), range(12)
    batch = trained(RunBatch("q-learning", values, seeds, mdp, episodes=2), 10)
    stops = [alone(mdp, seed, "q-learning", values, 2**60, 2)[2] for seed in seeds]
    assert list(map(Stop, batch.stop)) == stops
    assert {Stop.DIVERGED, Stop.DONE} == set(stops)
    assert all(
        episodes == 2 for episodes, stop in zip(batch.episodes, stops, strict=True) if stop is Stop.DONE
    )
