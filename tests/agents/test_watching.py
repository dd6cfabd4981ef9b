"""Watching stops a loop after exactly the right step."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from random_worlds import worlds
from test_environment_loop import HYPERPARAMETERS, Line, Table, facts, lake, untabled
from test_every_algorithm import any_hyperparameters, everything, learner
from two_forms import examples, interpreted

from rl_tui.agents.catalogue import BY_ID
from rl_tui.agents.exact.policy_figures import greedy_policy
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.agents.kernels.position import Stop
from rl_tui.agents.kernels.watch import NOTHING_NOTICED, WatchedEvents, Watching
from rl_tui.agents.learner import EPISODES_LOGGED, UNLIMITED, Learner
from rl_tui.common.streams import streams
from rl_tui.worlds.environment import StepResult
from rl_tui.worlds.mdp.space import all_pairs
from rl_tui.worlds.mdp.tabular_mdp import Outcome, TabularMDP, Transition, tabular_mdp

marks = st.frozensets(st.integers(0, 5), max_size=2)
watchings = st.builds(
    Watching,
    reward=st.booleans(),
    policy=st.booleans(),
    cell=st.none() | st.integers(0, 5),
    threshold=st.sampled_from([-0.5, 0.0, 0.3, 1.0]),
    states=marks,
    pairs=marks,
)


def known(watching: Watching, ours: Learner) -> Watching:
    space = ours.space
    return Watching(
        watching.reward,
        watching.policy,
        watching.cell if watching.cell is not None and watching.cell < space.pairs else None,
        watching.threshold,
        frozenset(each for each in watching.states if each < space.states),
        frozenset(each for each in watching.pairs if each < space.pairs),
    )


class Look:
    """Look at a learner after every single step, through its public attributes only."""

    def __init__(self, ours: Learner, watching: Watching) -> None:
        self._ours, self._watching = ours, watching
        self._side = self._sign()
        self._policy = self._greedy()

    def _sign(self) -> int:
        cell = self._watching.cell
        return 0 if cell is None else int(np.sign(self._ours.q[cell] - self._watching.threshold))

    def _greedy(self) -> list[float]:
        return greedy_policy(self._ours.space, self._ours.q, self._ours.hyperparameters.ties).tolist()

    def again(self) -> WatchedEvents:
        ours, watching, last = self._ours, self._watching, self._ours.last_step
        assert last is not None
        side, policy = self._sign(), self._greedy()
        reached, changed = self._side not in (0, side), policy != self._policy
        self._side, self._policy = side, policy
        arrived = [last.next_state] if ours.plans else [last.next_state, ours.state]
        taken = list(ours.space.pairs_of(last.state)) if ours.plans else [last.pair]
        return WatchedEvents(
            reward=watching.reward and last.reward != 0.0,
            policy=watching.policy and changed,
            cell=watching.cell is not None and reached,
            state=next((state for state in arrived if state in watching.states), None),
            pair=next((pair for pair in taken if pair in watching.pairs), None),
        )


def assert_watched_alike(watched: Learner, single: Learner, watching: Watching, steps: int) -> None:
    watched.watch(watching)
    look = Look(single, watching)
    while single.step < steps:
        stop, seen = Stop.DONE, NOTHING_NOTICED
        while stop is Stop.DONE and seen == NOTHING_NOTICED and single.step < steps:
            stop = single.advance(1)
            single.drain_episodes()
            seen = look.again()
        came = watched.advance(steps - watched.step)
        watched.drain_episodes()
        assert (watched.step, watched.noticed) == (single.step, seen)
        if stop is not Stop.DONE:  # for good: a finished planner
            assert came is stop
            return
        assert came is (Stop.DONE if seen == NOTHING_NOTICED else Stop.NOTICED)


@pytest.mark.parametrize("algorithm", BY_ID)
@examples(20)
@given(worlds(), any_hyperparameters, st.integers(0, 1000), watchings)
@pytest.mark.slow
def test_it_stops_where_a_look_at_every_step_finds_something(
    algorithm: str, mdp: TabularMDP, hyperparameters: Hyperparameters, seed: int, watching: Watching
) -> None:
    watched, single, unwatched = (learner(mdp, algorithm, hyperparameters, seed) for _ in range(3))
    assert_watched_alike(watched, single, known(watching, watched), 120)
    unwatched.advance(120)
    unwatched.drain_episodes()
    assert everything(watched) == everything(unwatched)


@pytest.mark.parametrize("algorithm", ["q-learning", "sarsa"])
@examples(10)
@given(st.integers(0, 1000), watchings)
def test_a_stepped_environment_is_watched_alike(algorithm: str, seed: int, watching: Watching) -> None:
    mdp = lake()
    watched, single, unwatched = (
        Learner(untabled(mdp), algorithm, HYPERPARAMETERS, streams(seed), Table(mdp, seed)) for _ in range(3)
    )
    assert_watched_alike(watched, single, known(watching, watched), 150)
    unwatched.advance(150)
    assert facts(watched) == facts(unwatched)


@pytest.mark.compiled
@pytest.mark.parametrize("algorithm", ["q-learning", "value-iteration"])
@examples(10)
@given(worlds(), any_hyperparameters, watchings)
def test_interpreted_watches_as_compiled_does(
    algorithm: str, mdp: TabularMDP, hyperparameters: Hyperparameters, watching: Watching
) -> None:
    compiled, in_python = (learner(mdp, algorithm, hyperparameters) for _ in range(2))
    with interpreted():
        in_python.watch(known(watching, in_python))
        stops = [in_python.advance(20) for _ in range(5)]
        noticed, step = in_python.noticed, in_python.step
    compiled.watch(known(watching, compiled))
    assert [compiled.advance(20) for _ in range(5)] == stops
    assert (compiled.noticed, compiled.step) == (noticed, step)
    assert everything(compiled) == everything(in_python)


def corridor(*rewards: float) -> TabularMDP:
    names = [f"s{state}" for state in range(len(rewards) + 1)]
    steps = [
        Transition(state, 0, [Outcome(1.0, state + 1, reward, state + 1 == len(rewards))])
        for state, reward in enumerate(rewards)
    ]
    return tabular_mdp(names, ["on"], steps, {0: 1.0})


CERTAIN = Hyperparameters(alpha=1.0, gamma=0.5, epsilon=0.0)


def test_a_reward_is_noticed_also_where_it_ends_the_episode() -> None:
    ours = learner(corridor(0.0, 0.0, -1.0), "q-learning", CERTAIN)
    ours.watch(Watching(reward=True))
    assert ours.advance(100) is Stop.NOTICED
    assert (ours.step, ours.episodes, ours.state, ours.episode_step) == (3, 1, 0, 0)
    assert ours.noticed == WatchedEvents(reward=True)
    assert ours.drain_episodes().returns.tolist() == [-1.0]
    assert ours.advance(2) is Stop.DONE
    assert ours.noticed == NOTHING_NOTICED


def test_where_an_episode_starts_is_an_arrival() -> None:
    ours = learner(corridor(0.0, 0.0, 1.0), "q-learning", CERTAIN)
    ours.watch(Watching(states=frozenset({0})))
    assert ours.advance(100) is Stop.NOTICED
    assert (ours.step, ours.noticed.state) == (3, 0)
    ours.watch(Watching(states=frozenset({3})))
    assert ours.advance(100) is Stop.NOTICED
    assert (ours.step, ours.noticed.state) == (6, 3)


def test_a_cell_is_noticed_whenever_it_comes_to_its_threshold_and_not_while_it_stays() -> None:
    ours = learner(corridor(1.0), "q-learning", Hyperparameters(alpha=0.5, epsilon=0.0))
    ours.watch(Watching(cell=0, threshold=0.75))
    assert ours.advance(100) is Stop.NOTICED
    assert (ours.step, ours.q[0], ours.noticed) == (2, 0.75, WatchedEvents(cell=True))
    assert ours.advance(100) is Stop.DONE
    ours.watch(Watching(cell=0, threshold=0.75))
    assert ours.advance(100) is Stop.DONE


def test_a_full_log_and_something_noticed_are_both_reported() -> None:
    ours = learner(corridor(1.0), "q-learning", CERTAIN)
    ours.advance(EPISODES_LOGGED - 1)
    ours.watch(Watching(reward=True))
    assert ours.advance(10) is Stop.NOTICED
    assert ours.advance(10) is Stop.EPISODES_FULL
    assert ours.noticed == NOTHING_NOTICED
    assert len(ours.drain_episodes().returns) == EPISODES_LOGGED
    assert ours.advance(10) is Stop.NOTICED


def test_what_stops_for_good_is_reported_before_what_is_noticed() -> None:
    ours = learner(corridor(1e13), "q-learning", CERTAIN)
    ours.watch(Watching(reward=True))
    assert ours.advance(10) is Stop.DIVERGED
    assert ours.noticed == WatchedEvents(reward=True)


def test_a_step_after_which_the_environment_fails_is_noticed_too() -> None:
    ours = Learner(
        all_pairs(["here"], ["on"], 0),
        "q-learning",
        CERTAIN,
        streams(0),
        Line(StepResult(0, 1.0, True, False), starts=1),
    )
    ours.watch(Watching(reward=True))
    assert ours.advance(10) is Stop.WORLD_FAILED
    assert ours.noticed == WatchedEvents(reward=True)


def test_other_ties_are_no_change_of_the_policy() -> None:
    ours = learner(lake(), "q-learning", Hyperparameters(ties="random"))
    ours.watch(Watching(policy=True))
    ours.configure(Hyperparameters(ties="first"))
    single = learner(lake(), "q-learning", Hyperparameters(ties="first"))
    look = Look(single, Watching(policy=True))
    ours.advance(UNLIMITED)
    while not (single.advance(1) or look.again().policy):
        pass
    assert ours.step == single.step


def test_a_restored_learner_is_watched_from_the_estimates_it_came_back_to() -> None:
    ours = learner(corridor(0.0, 1.0), "q-learning", CERTAIN)
    kept = ours.checkpoint()
    ours.watch(Watching(cell=1, threshold=0.5))
    for _ in range(2):
        assert ours.advance(100) is Stop.NOTICED
        assert ours.step == 2
        ours.restore(kept)


@pytest.mark.parametrize(
    ("watching", "named"),
    [
        (Watching(cell=9), "cell 9; expected a pair in 0..1"),
        (Watching(states=frozenset({3})), "state 3; expected one in 0..2"),
        (Watching(pairs=frozenset({-1})), "pair -1; expected one in 0..1"),
    ],
)
def test_what_is_not_there_cannot_be_watched(watching: Watching, named: str) -> None:
    ours = learner(corridor(0.0, 1.0), "q-learning", CERTAIN)
    with pytest.raises(ValueError, match=named):
        ours.watch(watching)


def test_watching_ends_on_demand() -> None:
    ours = learner(corridor(1.0), "q-learning", CERTAIN)
    ours.watch(Watching(reward=True))
    ours.watch(None)
    assert ours.advance(10) is Stop.DONE
