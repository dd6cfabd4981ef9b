"""Rules that hold for every algorithm."""

from __future__ import annotations

import importlib
import importlib.util
import itertools
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from plain_world import PlainWorld, Table, as_array
from random_worlds import worlds
from two_forms import advance, examples

from rl_tui.agents.algorithms.family import NO_STATE
from rl_tui.agents.catalogue import BY_ID
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.learner import Learner
from rl_tui.common.streams import streams
from rl_tui.worlds.mdp.tabular_mdp import Outcome, TabularMDP, Transition, tabular_mdp


def written(*algorithms: str) -> list[Any]:
    return [
        pytest.param(
            algorithm,
            marks=pytest.mark.skipif(
                importlib.util.find_spec(BY_ID[algorithm].module) is None, reason=f"{algorithm} is to come"
            ),
        )
        for algorithm in algorithms
    ]


EVERY = written(*BY_ID)
LEARNING = written(*(algorithm.id for algorithm in BY_ID.values() if not algorithm.planner))

any_hyperparameters = st.builds(
    Hyperparameters,
    alpha=st.sampled_from([0.1, 0.5, 1.0, "sample-average"]),
    step_size_schedule=st.sampled_from(["constant", "linear", "exponential", "sample-average"]),
    alpha_min=st.sampled_from([0.0, 0.2]),
    alpha_decay=st.sampled_from([0.0, 0.01]),
    gamma=st.sampled_from([0.0, 0.9, 1.0]),
    epsilon=st.sampled_from([0.0, 0.1, 1.0]),
    epsilon_schedule=st.sampled_from(["constant", "linear", "exponential"]),
    epsilon_min=st.sampled_from([0.0, 0.3]),
    epsilon_decay=st.sampled_from([0.0, 0.01]),
    lambda_=st.sampled_from([0.0, 0.5, 1.0]),
    traces=st.sampled_from(["replacing", "accumulating"]),
    n=st.sampled_from([1, 2, 3, 8]),
    planning_steps=st.sampled_from([0, 1, 5]),
    threshold=st.sampled_from([0.0, 0.01]),
    initial_q=st.sampled_from([0.0, 2.5]),
    ties=st.sampled_from(["random", "first"]),
)
SEEDS = st.integers(0, 1000)


def learner(mdp: TabularMDP, algorithm: str, hyperparameters: Hyperparameters, seed: int = 0) -> Learner:
    return Learner(mdp, algorithm, hyperparameters, streams(seed))


def everything(ours: Learner) -> list[Any]:
    state = ours.checkpoint()
    parts = (state.memory, state.rule, state.drift, state.position, state.record, ours.drain_episodes())
    return [
        state.algorithm,
        state.hyperparameters,
        state.stop,
        state.streams,
        [[array.tobytes() for array in arrays] for arrays in parts],
    ]


@pytest.mark.parametrize("algorithm", LEARNING)
@examples(40)
@given(worlds(), any_hyperparameters, SEEDS, st.integers(0, 300))
def test_the_kernel_does_what_the_box_says_bit_for_bit(
    algorithm: str, mdp: TabularMDP, hyperparameters: Hyperparameters, seed: int, steps: int
) -> None:
    name = f"plain_{algorithm.replace('-', '_')}"
    box: Callable[[PlainWorld], Table] = getattr(importlib.import_module(name), name)
    ours = learner(mdp, algorithm, hyperparameters, seed)
    ours.advance(steps)
    episodes = ours.drain_episodes()
    world = PlainWorld(mdp, hyperparameters, streams(seed), ours.step)  # fewer where it ran away
    q = box(world)
    assert ours.q.tolist() == as_array(q).tolist()
    assert ours.visits.tolist() == as_array(world.visits).tolist()
    assert list(zip(episodes.returns.tolist(), episodes.lengths.tolist(), strict=True)) == world.finished


@pytest.mark.exhaustive("compiles the loop of every algorithm; test_change_over.py does some of them")
@pytest.mark.compiled
@pytest.mark.parametrize("algorithm", EVERY)
@examples(15)
@given(worlds(), any_hyperparameters, SEEDS, st.integers(0, 150))
def test_interpreted_and_compiled_give_the_same_bits(
    algorithm: str, mdp: TabularMDP, hyperparameters: Hyperparameters, seed: int, steps: int
) -> None:
    compiled, interpreted = (learner(mdp, algorithm, hyperparameters, seed) for _ in range(2))
    compiled.advance(steps)
    advance(interpreted, steps, is_interpreted=True)
    assert everything(compiled) == everything(interpreted)


@pytest.mark.parametrize("algorithm", EVERY)
@examples(20)
@given(worlds(), any_hyperparameters, SEEDS, st.lists(st.integers(0, 60), max_size=8))
def test_how_the_work_is_cut_does_not_matter(
    algorithm: str, mdp: TabularMDP, hyperparameters: Hyperparameters, seed: int, chunks: list[int]
) -> None:
    whole, cut = (learner(mdp, algorithm, hyperparameters, seed) for _ in range(2))
    whole.advance(sum(chunks))
    for chunk in chunks:
        cut.advance(chunk)
    assert everything(whole) == everything(cut)


@pytest.mark.parametrize("algorithm", EVERY)
@examples(15)
@given(worlds(), any_hyperparameters, st.integers(0, 60), st.integers(0, 60))
def test_a_checkpoint_brings_everything_back_in_any_learner(
    algorithm: str, mdp: TabularMDP, hyperparameters: Hyperparameters, before: int, after: int
) -> None:
    straight, rewound = (learner(mdp, algorithm, hyperparameters) for _ in range(2))
    straight.advance(before + after)
    straight.drain_episodes()
    expected = everything(straight)
    rewound.advance(before)
    rewound.drain_episodes()
    kept = rewound.checkpoint()
    rewound.configure(Hyperparameters(alpha=1.0, epsilon=1.0, n=5))
    rewound.advance(100)
    another = learner(mdp, "q-learning", Hyperparameters(epsilon=0.5), seed=9)
    another.advance(7)
    for restored in (rewound, another):
        restored.restore(kept)
        restored.advance(after)
        restored.drain_episodes()
        assert everything(restored) == expected


def eight_states(time_limit: int) -> TabularMDP:
    """A ring that slips, with a terminal state next to every state."""
    return tabular_mdp(
        [f"s{state}" for state in range(9)],
        ["on", "back", "out"],
        [
            Transition(state, action, [Outcome(0.8, to, -1.0, to == 8), Outcome(0.2, state, 0.5, False)])
            for state in range(8)
            for action, to in enumerate([(state + 1) % 8, (state - 1) % 8, 8])
        ],
        {0: 1.0},
        time_limit,
    )


@pytest.mark.parametrize("time_limit", [0, 5])
def test_any_algorithm_goes_on_where_another_stopped(time_limit: int) -> None:
    there = [one for one in BY_ID if importlib.util.find_spec(BY_ID[one].module)]
    for before, after in itertools.permutations(there, 2):
        ours = learner(eight_states(time_limit), before, Hyperparameters(epsilon=0.5, accuracy=0.0))
        ours.advance(9)
        while not ours.episode_step:
            ours.advance(1)
        step, q, visits = ours.step, ours.q.tolist(), ours.visits.tolist()
        ours.switch(after)
        assert (ours.q.tolist(), ours.visits.tolist()) == (q, visits)
        for _ in range(30):
            ours.advance(1)
            assert ours.plans or not time_limit or ours.episode_step < time_limit, (before, after)
        assert np.isfinite(ours.q).all()
        assert ours.stop_reason == ""
        assert ours.plans or (ours.step, ours.visits.sum()) == (step + 30, sum(visits) + 30)


@pytest.mark.parametrize("algorithm", LEARNING)
@examples(10)
@given(worlds(), any_hyperparameters, SEEDS)
def test_the_update_that_is_reported_is_the_one_that_was_made(
    algorithm: str, mdp: TabularMDP, hyperparameters: Hyperparameters, seed: int
) -> None:
    ours = learner(mdp, algorithm, hyperparameters, seed)
    for _ in range(40):
        before = ours.q.copy()
        ours.advance(1)
        ours.drain_episodes()
        last = ours.last_step
        moved = np.flatnonzero(ours.q != before)
        if not last.learned:
            assert (len(moved), last.others) == (0, 0)
            continue
        assert last.after == last.before + last.step_size * last.td_error
        assert len(moved) <= last.others + 1
        if last.others == 0:
            assert set(moved) <= {last.updated_pair}
        if last.others == 0 and last.table == 0:
            assert (before[last.updated_pair], ours.q[last.updated_pair]) == (last.before, last.after)


@pytest.mark.parametrize("algorithm", LEARNING)
@pytest.mark.parametrize(("ends", "value"), [(False, 1.0 + 0.5 * 10.0), (True, 1.0)])
def test_a_terminated_step_does_not_bootstrap_a_truncated_one_does(
    algorithm: str, ends: bool, value: float
) -> None:
    mdp = tabular_mdp(["s", "end"], ["a"], [Transition(0, 0, [Outcome(1.0, 0, 1.0, ends)])], {0: 1.0}, 1)
    # Prioritized sweeping learns from its queue only
    planning_steps = 1 if algorithm == "prioritized-sweeping" else 0
    hyperparameters = Hyperparameters(alpha=1.0, gamma=0.5, initial_q=10.0, planning_steps=planning_steps)
    ours = learner(mdp, algorithm, hyperparameters)
    ours.advance(1)
    last = ours.last_step
    assert (last.terminated, last.truncated, last.after) == (ends, not ends, value)


@pytest.mark.parametrize("algorithm", EVERY)
@examples(10)
@given(worlds(), any_hyperparameters, SEEDS)
def test_the_bootstrap_was_read_from_the_state_that_is_named(
    algorithm: str, mdp: TabularMDP, hyperparameters: Hyperparameters, seed: int
) -> None:
    ours = learner(mdp, algorithm, hyperparameters, seed)
    row = BY_ID[algorithm]
    for _ in range(40):
        tables = [ours.q.copy(), *ours.remembered("q1", "q2")]
        ours.advance(1)
        ours.drain_episodes()
        last = ours.last_step
        state, is_elsewhere = last.bootstrap_state, last.updated_pair != last.pair
        if state == NO_STATE:
            assert row.planner or last.bootstrap == 0.0
            assert row.planner or is_elsewhere or not row.update.one_step or last.terminated
            continue
        assert last.learned
        assert (row.update.one_step and is_elsewhere) or (state == last.next_state and not last.terminated)
        # With several updates, the estimates have already moved by the time of the last
        if row.update.one_step or not last.others:
            estimates = [table[pair] for table in tables[-2:] for pair in mdp.pairs_of(state)]
            slack = 1e-12 * max(map(abs, estimates))
            assert min(estimates) - slack <= last.bootstrap <= max(estimates) + slack


@pytest.mark.parametrize("algorithm", EVERY)
@examples(5)
@given(worlds(), any_hyperparameters, SEEDS)
def test_the_last_td_errors_are_kept_with_the_pairs_that_moved(
    algorithm: str, mdp: TabularMDP, hyperparameters: Hyperparameters, seed: int
) -> None:
    ours, at_once = (learner(mdp, algorithm, hyperparameters, seed) for _ in range(2))
    assert not len(ours.counters.td_errors)
    updates = []
    for step in range(1, 320):
        ours.advance(1)
        ours.drain_episodes()
        last = ours.last_step
        if last.step == step and last.learned:  # a finished planner takes no more steps
            updates.append((last.td_error, last.updated_pair))
    at_once.advance(ours.step)
    for counters in (ours.counters, at_once.counters):
        kept = zip(counters.td_errors.tolist(), counters.updated_pairs.tolist(), strict=True)
        assert list(kept) == updates[-256:]
