"""Watching it learn."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
import pytest
from playing import busy
from recipes import recipe, replay

from rl_tui.live.commands import GoTo, HideAnswer, Pause, Play, Restart, SetSpeed, Train, WatchLearning
from rl_tui.live.pace.transport import REST, SPEEDS, Stage
from rl_tui.live.playback import Playback
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.runs.recipe import Recipe

FIRST_REWARD = 1_866
"""The step of the first reward on the lake with seed 0."""


class Clock:
    now = 100.0

    def __call__(self) -> float:
        return self.now


class Watched:
    """A playback in watching mode, with a clock on which only waiting takes time."""

    def __init__(self, made_from: Recipe, *, automatic: bool = True) -> None:
        self.clock = Clock()
        self.playback = Playback(
            made_from, speed=10.0, automatic=automatic, clock=self.clock, on_exact=lambda: None
        )
        while busy(self.playback):
            self.playback.work()
        self.playback.handle(WatchLearning())

    def turn(self) -> Snapshot:
        wait = self.playback.work()
        shown = self.playback.snapshot()
        assert wait is not None
        self.clock.now += wait
        return shown

    def turns(self) -> Iterator[tuple[float, Snapshot]]:
        while True:
            spent = self.clock.now - Clock.now
            shown = self.turn()
            if not shown.playback.watching:
                return
            yield spent, shown


def with_value(shown: Snapshot) -> int:
    space = shown.world.space
    best = [max(shown.agent.q[pairs]) for each in range(space.states) if (pairs := space.pairs_of(each))]
    return int(np.count_nonzero(best))


@pytest.mark.interpreted
def test_the_lake_is_seen_to_learn_within_five_seconds() -> None:
    """It shows the first reward soon, then each state with a new value, then an optimal policy."""
    moments = [
        (spent, shown.counters.step, with_value(shown))
        for spent, shown in Watched(recipe("frozenlake")).turns()
    ]
    first = next(spent for spent, step, _ in moments if step >= FIRST_REWARD)
    assert 1.0 < first < 2.0
    early = [(spent, count) for spent, _, count in moments if spent < 5.0]
    assert sorted({count for _, count in early}) == [0, 1, 2, 3, 4, 5, 6]
    begins = [next(spent for spent, each in early if each == count) for count in range(1, 7)]
    assert all(later - earlier > REST for earlier, later in pairwise(begins))


def test_it_ends_at_a_speed_that_stays() -> None:
    watched = Watched(recipe("frozenlake"))
    assert sum(1 for _ in watched.turns()) > 0
    for _ in range(2):
        shown = watched.turn()
        assert shown.playback.phase is Phase.RUNNING
        assert (shown.playback.watching, shown.playback.speed) == ("", SPEEDS[Stage.OPTIMAL][-1])
        watched.playback.handle(Pause())
        watched.playback.handle(Play())


@pytest.mark.parametrize("scenario", ["frozenlake", "cliff", "bandit"])
def test_the_run_is_that_of_its_recipe(scenario: str) -> None:
    watched = Watched(recipe(scenario))
    for _ in range(200):
        shown = watched.turn()
    straight = replay(shown.recipe, (), shown.counters.step)
    assert shown.agent.q.tolist() == straight.learner.q.tolist()
    assert shown.agent.visits.tolist() == straight.learner.visits.tolist()
    assert not watched.playback.record.lanes[0].branches[0].journal


@pytest.mark.parametrize("algorithm", ["value-iteration", "dyna-q", "monte-carlo", "double-q-learning"])
def test_every_kind_of_agent_comes_to_an_optimal_policy(algorithm: str) -> None:
    watched = Watched(recipe("frozenlake", algorithm=algorithm))
    for spent, shown in watched.turns():
        if shown.playback.speed in SPEEDS[Stage.OPTIMAL]:
            break
        assert spent < 60.0
    else:
        pytest.fail("no policy was found")


@pytest.mark.parametrize("hidden", [False, True])
def test_that_an_optimal_policy_is_found_is_not_told_while_the_answer_is_hidden(hidden: bool) -> None:
    watched = Watched(recipe("frozenlake", algorithm="dyna-q"))
    watched.playback.handle(HideAnswer(is_hidden=hidden))
    said = {
        shown.playback.watching
        for _, shown in watched.turns()
        if shown.playback.speed in SPEEDS[Stage.OPTIMAL]
    }
    assert ("optimal policy found" in said, "nothing new" in said) == (not hidden, hidden)
    assert not any("optimal" in each for each in said) or not hidden


def test_where_nothing_can_be_chosen_values_are_seen_to_spread() -> None:
    counts = [with_value(shown) for _, shown in Watched(recipe("random-walk", initial_q=0.0)).turns()]
    assert set(range(1, 6)) <= set(counts)


def test_pulls_of_a_bandit_get_quicker() -> None:
    speeds = [shown.playback.speed for _, shown in Watched(recipe("bandit")).turns()]
    assert list(dict.fromkeys(speeds)) == list(SPEEDS[Stage.PULLS][:-1])


def test_pausing_goes_on_where_it_was_and_a_speed_ends_it() -> None:
    watched = Watched(recipe("frozenlake"))
    watched.turn()
    watched.playback.handle(Pause())
    assert watched.playback.snapshot().playback.phase is Phase.PAUSED
    watched.playback.handle(Play())
    assert watched.turn().playback.watching
    watched.playback.handle(SetSpeed(300.0))
    shown = watched.turn()
    assert (shown.playback.watching, shown.playback.speed) == ("", 300.0)
    assert shown.playback.phase is Phase.RUNNING


def test_what_gets_a_value_again_after_going_back_is_shown_again() -> None:
    watched = Watched(recipe("frozenlake"))
    next(shown for _, shown in watched.turns() if shown.counters.step >= FIRST_REWARD)
    watched.playback.handle(GoTo(step=FIRST_REWARD - 1))
    while busy(watched.playback):
        watched.playback.work()
    watched.playback.handle(Play())
    before = watched.clock.now
    assert with_value(watched.turn()) == 1
    assert watched.clock.now - before == pytest.approx(REST, abs=0.01)


@pytest.mark.parametrize("to_its_end", [False, True])
def test_a_run_that_starts_again_is_watched_again(to_its_end: bool) -> None:
    watched = Watched(recipe("frozenlake"))
    for _, shown in watched.turns():
        if shown.counters.step >= FIRST_REWARD and not to_its_end:
            break
    watched.playback.handle(Restart(recipe("frozenlake", seed=1)))
    while busy(watched.playback):
        watched.playback.work()
    assert watched.playback.snapshot().playback.phase is Phase.PAUSED
    watched.playback.handle(Play())
    shown = watched.turn()
    assert shown.playback.watching
    assert shown.playback.speed == SPEEDS[Stage.FIRST_REWARD][0]


def test_by_hand_it_says_where_it_stands_whatever_the_time() -> None:
    watched = Watched(recipe("frozenlake"), automatic=False)
    said = []
    for steps in (100, 2_000, 2_000):
        watched.playback.handle(Train(steps))
        while watched.playback.on_the_way:
            watched.playback.work()
        watched.clock.now += 50.0
        said.append(watched.playback.snapshot().playback)
    assert [each.speed for each in said] == [1_000.0] * 3
    assert len({each.watching for each in said}) == 3
