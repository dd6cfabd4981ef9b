"""The trail of an episode."""

from __future__ import annotations

from collections.abc import Callable
from itertools import count

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from playing import begin, do, stand
from recipes import recipe

from rl_tui.live.commands import (
    AddLane,
    Apply,
    ChooseBranch,
    Command,
    EpisodeBack,
    GoTo,
    MarkLane,
    Pause,
    Play,
    RunEpisode,
    SetSpeed,
    Step,
    StepBack,
    Take,
    Train,
)
from rl_tui.live.playback import Playback
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.recipe import JournalEntry, Recipe, SetParameter, SwitchAlgorithm
from rl_tui.runs.run import Run
from rl_tui.runs.timeline.trail import MOST_STEPS, Trail, TrailRecorder


def begin_at_once(made_from: Recipe, clock: Callable[[], float] = lambda: 0.0) -> Playback:
    playback = Playback(made_from, speed=None, automatic=False, clock=clock, on_exact=lambda: None)
    while playback.on_the_way:
        playback.work()
    return playback


def plain_trail(made_from: Recipe, journal: tuple[JournalEntry, ...], steps: int) -> Trail:
    run = Run(made_from)
    recorder = TrailRecorder()
    for step in range(1, steps + 1):
        run.follow(journal, step)
        recorder.note(run.learner.last_step, run.world)
    return recorder.up_to(run.learner.last_step)


def assert_plain(playback: Playback, snapshot: Snapshot) -> None:
    if snapshot.counters.is_at_beginning:
        assert snapshot.trail == ()
        return
    lane = playback.record.lanes[playback.record.shown]
    journal = lane.branches[lane.branch].journal
    assert snapshot.trail == plain_trail(lane.recipe, journal, snapshot.counters.step)
    last = snapshot.counters.last_step
    if last is None or last.planned:
        assert snapshot.trail == ()
        return
    assert len(snapshot.trail) == min(MOST_STEPS, last.episode_step)
    assert snapshot.trail[-1].step == snapshot.counters.step
    for one, next_one in zip(snapshot.trail, snapshot.trail[1:], strict=False):
        assert (one.step + 1, one.next_state) == (next_one.step, next_one.state)


MOVES = st.one_of(
    st.builds(Train, st.integers(0, 200)),
    st.just(Step()),
    st.just(RunEpisode()),
    st.just(StepBack()),
    st.just(EpisodeBack()),
    st.builds(GoTo, st.integers(0, 300)),
    st.builds(GoTo, st.none(), st.integers(1, 40)),
    st.builds(Take, st.integers(0, 3)),
    st.builds(Apply, st.builds(SetParameter, st.just("epsilon"), st.sampled_from([0.0, 0.5, 1.0]))),
    st.builds(Apply, st.builds(SwitchAlgorithm, st.sampled_from(["q-learning", "value-iteration"]))),
    st.builds(ChooseBranch, st.integers(0, 2)),
)


@pytest.mark.parametrize("begins", [begin, begin_at_once])
@settings(max_examples=15, deadline=None)
@given(moves=st.lists(MOVES, max_size=8))
def test_whatever_was_done_the_trail_is_that_of_a_plain_replay(
    begins: Callable[[Recipe], Playback], moves: list[Command]
) -> None:
    playback = begins(recipe("frozenlake-slippery", seed=3))
    for move in moves:
        snapshot = do(playback, move)
        assert_plain(playback, snapshot)


def test_going_back_shortens_the_trail_and_a_step_goes_on_from_there() -> None:
    playback = begin(recipe("cliff"))
    after = do(playback, *[Step()] * 6)
    before = do(playback, StepBack(), StepBack())
    assert before.trail == after.trail[:4]
    assert do(playback, Step()).trail == after.trail[:5]


def test_a_long_episode_keeps_its_last_steps() -> None:
    playback = begin_at_once(recipe("cliff", epsilon=1.0))
    snapshot = do(playback, Train(300))
    assert snapshot.counters.episode_step > MOST_STEPS
    assert_plain(playback, snapshot)


def test_the_trail_of_a_finished_episode_stays_until_the_next_step() -> None:
    playback = begin(recipe("frozenlake-slippery", seed=1))
    ended = do(playback, RunEpisode())
    assert len(ended.trail) == ended.counters.last_step.episode_step
    assert len(do(playback, Step()).trail) == 1


def test_a_slip_is_a_step_on_which_another_action_happened_than_was_chosen() -> None:
    playback = begin(recipe("frozenlake-slippery", seed=1))
    slips = []
    for _ in range(12):
        snapshot = do(playback, Step())
        last, mdp = snapshot.counters.last_step, snapshot.world.mdp
        slipped = mdp.outcome_action[last.outcome] != mdp.pair_action[last.pair]
        assert snapshot.trail[-1].slipped == slipped
        slips.append(slipped)
    assert 0 < sum(slips) < 12


def test_finding_the_trail_leaves_run_and_record_as_they_are() -> None:
    playback = begin_at_once(recipe("cliff", seed=2))
    playback.handle(Train(500))
    while playback.on_the_way:
        playback.work()
    group = playback.group
    before, record = stand(group.current.run), playback.record
    assert not group.trails_are_whole
    assert playback.snapshot().trail
    assert stand(group.current.run) == before
    assert playback.record == record


@pytest.mark.parametrize("speed", [1.0, 30.0, 100.0, None])
def test_a_run_faster_than_can_be_seen_shows_no_trail_until_it_pauses(speed: float | None) -> None:
    playback = begin(recipe("frozenlake-slippery", seed=2))
    running = do(playback, Train(50), SetSpeed(speed), Play())
    assert bool(running.trail) == (speed is not None and speed <= 30)
    assert_plain(playback, do(playback, Pause()))


def test_the_lane_beside_the_one_shown_has_its_own_trail() -> None:
    playback = begin(recipe("cliff"))
    snapshot = do(playback, AddLane((SwitchAlgorithm("sarsa"),)), MarkLane(0), *[Step()] * 5)
    assert len(snapshot.trail) == len(snapshot.beside.trail) == 5


def test_steps_that_do_not_follow_one_another_are_never_joined() -> None:
    run = Run(recipe("cliff"))
    recorder = TrailRecorder()
    for steps in (1, 1, 2, 1):
        run.advance(steps)
        recorder.note(run.learner.last_step, run.world)
    assert [each.step for each in recorder.up_to(run.learner.last_step)] == [4, 5]


def test_an_environment_that_is_stepped_has_the_trail_that_was_recorded() -> None:
    playback = begin_at_once(recipe("mountain-car"))
    assert len(do(playback, *[Step()] * 4).trail) == 4
    after = do(playback, Step())
    assert do(playback, Train(70)).trail == ()
    assert len(do(playback, Step()).trail) == 1
    assert do(playback, GoTo(5)).trail == after.trail


def test_a_picture_of_a_stepped_environment_does_not_depend_on_the_speed_of_the_machine() -> None:
    trails = set()
    for tick in (0.0, 1e-4, 0.003, 0.02, 0.1):
        playback = begin_at_once(recipe("mountain-car"), clock=(tick * each for each in count()).__next__)
        trails.update(do(playback, Train(steps)).trail for steps in (1_603, 8))
    assert sorted(map(len, trails)) == [0, 8]
