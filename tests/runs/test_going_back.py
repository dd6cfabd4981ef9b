"""After any actions, the state equals the journal, bit for bit."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from playing import Ticking, assert_true_to_the_record, begin, bits, do, functions_of, stand
from recipes import bandit, recipe
from snapshots import changed

from rl_tui.agents.hyperparameters import SAMPLE_AVERAGE
from rl_tui.live.commands import (
    AddBranch,
    AddLane,
    Apply,
    ChooseBranch,
    ChooseLane,
    ClearBreakpoints,
    Command,
    DropLane,
    EpisodeBack,
    FollowCell,
    GoTo,
    Pause,
    Play,
    RunEpisode,
    RunUntil,
    Step,
    StepBack,
    Take,
    ToggleBreakpoint,
    Train,
)
from rl_tui.live.pace.until import Event, Until
from rl_tui.live.playback import Playback
from rl_tui.live.record import Record
from rl_tui.live.sessions.session import encoded, read_session
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.runs.recipe import SetParameter, SwitchAlgorithm


def through_a_file(record: Record) -> Record:
    with TemporaryDirectory() as folder:
        path = Path(folder) / "session.json"
        path.write_bytes(encoded(record))
        return read_session(path).record()


SETTINGS = st.one_of(
    st.builds(SetParameter, st.just("alpha"), st.sampled_from([0.05, 0.5, SAMPLE_AVERAGE])),
    st.builds(SetParameter, st.just("epsilon"), st.sampled_from([0.0, 0.3, 1.0])),
    st.builds(SetParameter, st.just("gamma"), st.sampled_from([0.0, 0.5, 0.95])),
    st.builds(SetParameter, st.just("ties"), st.sampled_from(["random", "first"])),
    # each loop takes seconds to compile: of the expensive ones only one that waits, and a planner
    st.builds(SwitchAlgorithm, st.sampled_from(["q-learning", "sarsa", "n-step-sarsa", "value-iteration"])),
)


COMMANDS = st.one_of(
    st.builds(Train, st.integers(0, 300)),
    st.just(Step()),
    st.just(RunEpisode()),
    st.builds(Apply, SETTINGS),
    st.builds(Take, st.integers(0, 3)),
    st.just(StepBack()),
    st.just(EpisodeBack()),
    st.builds(GoTo, st.integers(-5, 400)),
    st.builds(GoTo, st.none(), st.integers(1, 60)),
    st.builds(ChooseBranch, st.integers(0, 3)),
    st.builds(
        RunUntil,
        st.sampled_from([Until(Event.REWARD), Until(Event.POLICY_CHANGE), Until(Event.EPISODE, number=20)]),
    ),
    st.builds(ToggleBreakpoint, st.integers(0, 3)),
    st.just(ClearBreakpoints()),
    st.builds(AddLane, st.tuples(SETTINGS)),
    st.builds(AddBranch, st.integers(0, 2)),
    st.builds(ChooseLane, st.integers(0, 3)),
    st.builds(DropLane, st.integers(0, 3)),
    st.just("save and load"),
)


@settings(max_examples=60, deadline=None)
@given(
    st.sampled_from(["student", "frozenlake-slippery", "bandit-drifting"]), st.lists(COMMANDS, max_size=14)
)
@pytest.mark.slow
def test_any_sequence_ends_in_the_bits_of_the_straight_replay(scenario: str, deeds: list[Any]) -> None:
    made_from = recipe(scenario)
    playback = begin(made_from)
    for deed in deeds:
        if deed == "save and load":
            saved = through_a_file(playback.record)
            playback = begin(saved.lanes[saved.shown].recipe, saved)
            assert playback.record == saved
        else:
            do(playback, deed)
    assert_true_to_the_record(playback)


@pytest.mark.parametrize("scenario", ["frozenlake-slippery", "student", "bandit", "blackjack", "cliff"])
def test_every_moment_looks_as_it_looked_then(scenario: str) -> None:
    playback = begin(recipe(scenario))
    moments = [do(playback, FollowCell(0))]
    for number in range(40):
        if number == 25:
            do(playback, Apply(SetParameter("epsilon", 0.5)))
            moments[-1] = playback.snapshot()
        moments.append(do(playback, Step()))
    for then in reversed(moments):
        assert looks(do(playback, GoTo(then.counters.step))) == looks(then)
    for then in moments[1:]:
        assert looks(do(playback, Step())) == looks(then)
    assert len(playback.record.lanes[0].branches) == 1


def looks(snapshot: Snapshot) -> Any:
    about_now = {"timeline", "world", "exact_answer"}
    if snapshot.world.new_environment is not None:
        about_now.add("trail")  # a stepped environment shows the recorded values
    shown = changed(snapshot, handled=0)
    return [bits(getattr(shown, each.name)) for each in fields(shown) if each.name not in about_now]


def test_playing_on_from_the_past_repeats_history_without_a_fork() -> None:
    playback = begin(recipe("frozenlake-slippery"))
    do(playback, Train(500), Apply(SetParameter("alpha", 0.5)), Train(500), Take(2), Train(499))
    end = stand(playback.group.current.run)
    shown = do(playback, GoTo(100))
    assert (shown.agent.hyperparameters.alpha, shown.timeline.in_past) == (0.1, True)
    shown = do(playback, Train(1400))
    assert stand(playback.group.current.run) == end
    assert len(shown.timeline.branches) == 1
    assert not shown.timeline.in_past


def test_a_change_in_the_past_forks_and_one_can_go_back_to_either() -> None:
    playback = begin(recipe("frozenlake-slippery"))
    do(playback, Train(1000))
    first = stand(playback.group.current.run)
    shown = do(playback, GoTo(400), Apply(SetParameter("alpha", 0.5)), Train(100))
    second = stand(playback.group.current.run)
    branch = shown.timeline.current
    assert (branch.name, branch.parent, branch.fork, branch.end) == ("branch 2", 0, 400, 500)
    shown = do(playback, ChooseBranch(0))
    assert (shown.counters.step, shown.timeline.current.end) == (500, 1000)  # the moment does not change
    do(playback, GoTo(1000))
    assert stand(playback.group.current.run) == first
    shown = do(playback, ChooseBranch(1))
    assert shown.counters.step == 500  # it was no further at that time
    assert stand(playback.group.current.run) == second
    assert shown.agent.hyperparameters.alpha == 0.5
    shown = do(playback, GoTo(450), ChooseBranch(0), ChooseBranch(1))
    assert (shown.counters.step, shown.agent.hyperparameters.alpha) == (450, 0.5)


def test_on_the_way_to_a_branch_all_moments_are_those_of_that_branch() -> None:
    playback = begin(recipe("frozenlake-slippery"))
    do(playback, Train(1000), GoTo(400), Apply(SetParameter("alpha", 0.5)), Train(600))
    group = playback.group
    for command, step in ((GoTo(700), 700), (StepBack(), 899)):
        group.seek_to(branch=1, step=900)
        while group.seeking:
            group.continue_seek(100)
        group.seek_to(branch=0)
        assert group.seeking
        shown = do(playback, command)
        assert (shown.counters.step, shown.timeline.branch) == (step, 0)
    assert_true_to_the_record(playback)


def test_a_change_at_the_very_end_is_no_fork() -> None:
    playback = begin(recipe("student"))
    shown = do(playback, Train(50), Apply(SetParameter("alpha", 0.5)), Train(1), StepBack())
    assert len(shown.timeline.branches) == 1
    assert shown.agent.hyperparameters.alpha == 0.5  # the settings of step 50 apply


def test_what_was_set_at_a_step_is_in_force_there_however_one_comes_to_it() -> None:
    playback = begin(recipe("student"))
    do(playback, Apply(SetParameter("alpha", 0.9)))
    for number in range(1, 13):
        do(playback, Step(), Apply(SetParameter("alpha", number / 100)))
    do(playback, Step())
    for number in range(1, 13):
        shown = do(playback, GoTo(number))
        assert (shown.agent.hyperparameters.alpha, len(playback.group.current.run.journal)) == (
            number / 100,
            number + 1,
        )
    assert do(playback, GoTo(0)).agent.hyperparameters.alpha == 0.9
    saved = playback.record
    assert begin(saved.lanes[0].recipe, saved).snapshot().agent.hyperparameters.alpha == 0.9


def test_back_by_steps_and_episodes() -> None:
    playback = begin(recipe("frozenlake"))
    shown = do(playback, RunEpisode(), RunEpisode(), Step(), Step())
    here = shown.counters.step
    assert do(playback, StepBack()).counters.step == here - 1
    assert do(playback, StepBack(), StepBack(), StepBack()).counters.step == here - 4
    shown = do(playback, GoTo(here), EpisodeBack())
    assert (shown.counters.step, shown.counters.episodes) == (here - 2, 2)
    shown = do(playback, EpisodeBack())
    assert (shown.counters.episodes, shown.counters.episode_step, shown.playback.phase) == (
        1,
        0,
        Phase.PAUSED,
    )
    assert do(playback, EpisodeBack(), EpisodeBack(), EpisodeBack(), StepBack()).counters.step == 0


def test_an_episode_is_gone_to_by_its_number() -> None:
    playback = begin(recipe("frozenlake-slippery"))
    do(playback, Train(5_000))
    shown = do(playback, GoTo(episode=7))
    assert (shown.counters.episodes, shown.counters.episode_step) == (6, 0)
    step = shown.counters.step
    assert do(playback, RunUntil(Until(Event.EPISODE, 9))).counters.is_at_beginning
    assert not do(playback, GoTo(step)).counters.is_at_beginning
    assert do(playback, GoTo(episode=10**9)).counters.step == 5_000
    assert do(playback, GoTo(step=10**12)).counters.step == 5_000
    assert do(playback, GoTo(step=-3)).counters.step == 0


def test_between_two_episodes_it_is_the_end_of_one_unless_a_beginning_was_asked_for() -> None:
    playback = begin(recipe("frozenlake"))
    first = do(playback, RunEpisode())
    ended = do(playback, RunEpisode()).counters
    last = ended.last_step
    assert (ended.state, ended.step_from, ended.is_at_beginning) == (last.next_state, 0, False)
    do(playback, Step())
    shown = do(playback, EpisodeBack())
    assert (shown.counters.state, shown.counters.step, shown.counters.is_at_beginning) == (
        0,
        ended.step,
        True,
    )
    assert shown.trail == ()
    assert do(playback, EpisodeBack()).counters.step == first.counters.step
    assert do(playback, Step(), StepBack()).counters.state == first.counters.state  # a step back: to its end
    again = do(playback, GoTo(ended.step)).counters
    assert (again.state, again.is_at_beginning) == (ended.state, False)


def test_an_episode_that_a_planner_cut_short_begins_where_the_one_before_ended() -> None:
    playback = begin(recipe("frozenlake-slippery"))
    shown = do(playback, RunEpisode(), Step(), Step())
    here = shown.counters.step - 2
    do(playback, Apply(SwitchAlgorithm("value-iteration")), Train(5))
    for _ in range(2):
        assert do(playback, GoTo(here + 7), EpisodeBack()).counters.step == here
    assert do(playback, GoTo(here + 2), EpisodeBack()).counters.step == here
    assert do(playback, GoTo(here + 3), GoTo(episode=2)).counters.step == here
    assert do(playback, EpisodeBack()).counters.step == 0


def test_time_travel_of_a_planner() -> None:
    playback = begin(recipe("frozenlake-slippery", algorithm="value-iteration"))
    shown = do(playback, Train(100_000))
    assert shown.playback.phase is Phase.DONE
    end = shown.counters.step
    shown = do(playback, StepBack())
    assert (shown.counters.step, shown.playback.phase) == (end - 1, Phase.PAUSED)
    shown = do(playback, EpisodeBack())
    assert shown.counters.episode_step == 0
    shown = do(playback, Play(), Pause(), Train(100_000))
    assert (shown.counters.step, shown.playback.phase) == (end, Phase.DONE)


def test_a_spent_budget_can_be_taken_back() -> None:
    playback = begin(bandit(50))
    assert do(playback, Train(1000)).playback.phase is Phase.SPENT
    shown = do(playback, StepBack())
    assert (shown.counters.step, shown.playback.phase) == (49, Phase.PAUSED)
    assert do(playback, Step()).playback.phase is Phase.SPENT


@pytest.mark.parametrize("scenario", ["blackjack", "cartpole", "egg"])
def test_a_stepped_world_is_replayed_from_the_seed(scenario: str) -> None:
    playback = begin(recipe(scenario))
    do(playback, Train(300), Apply(SetParameter("epsilon", 0.9)), Train(300))
    end = stand(playback.group.current.run)
    shown = do(playback, StepBack())
    assert shown.counters.step == 599
    do(playback, Step())
    assert stand(playback.group.current.run) == end
    playback.handle(GoTo(200))
    assert playback.phase is Phase.SEEKING
    assert "from the seed" in playback.snapshot().playback.message
    assert playback.snapshot().counters.step == 600  # the old moment is visible until the new one is ready
    while playback.on_the_way:
        playback.work()
    assert_true_to_the_record(playback)
    do(playback, Take(0), Train(50))
    assert_true_to_the_record(playback)


def test_a_journey_is_replaced_by_the_next_and_given_up_by_a_pause() -> None:
    playback = Playback(
        recipe("blackjack"), speed=None, automatic=True, clock=Ticking(), on_exact=lambda: None
    )
    while playback.on_the_way:
        playback.work()
    playback.handle(Train(3000))
    while playback.on_the_way:
        playback.work()
    playback.handle(GoTo(2000))
    assert playback.phase is Phase.SEEKING
    assert not playback.takes(Step())
    playback.handle(StepBack())
    playback.handle(GoTo(1000))
    playback.handle(StepBack())
    assert playback.record.lanes[0].step == 999  # the position after loading the session
    playback.work()
    playback.handle(Pause())
    assert (playback.phase, playback.snapshot().counters.step) == (Phase.PAUSED, 3000)


def test_what_cannot_be_done_is_told_and_ends_nothing() -> None:
    playback = begin(recipe("frozenlake"))
    for command in (ChooseBranch(3), ChooseBranch(-1), Apply(SetParameter("alpha", 7.0)), Take(9)):
        assert do(playback, command).playback.paused_by
    assert do(playback, Step()).counters.step == 1


def test_an_action_that_is_not_possible_is_refused() -> None:
    playback = begin(recipe("student"))
    before = stand(playback.group.current.run)
    shown = do(playback, Take(4))
    assert shown.playback.paused_by == "sleep is not available in state Class"
    assert stand(playback.group.current.run) == before
    assert playback.record.lanes[0].branches[0].journal == ()


@pytest.mark.parametrize(
    ("command", "most"),
    [(Step(), 90), (StepBack(), 105), (Apply(SetParameter("alpha", 0.2)), 95)],
    ids=["step", "back", "slider"],
)
def test_few_functions_run_from_a_command_to_its_snapshot(command: Command, most: int) -> None:
    """Lower these numbers when the way becomes shorter."""
    playback = begin(recipe("frozenlake"))
    do(playback, *[Step()] * 20, command, command)  # one-time reads and builds do not count
    # nor do values computed for some steps only, such as the value of another policy
    assert min(len(functions_of(playback, command)) for _ in range(3)) <= most


def test_what_a_branch_has_reached_is_known_as_long_as_one_is_in_its_past() -> None:
    playback = begin(recipe("student"))
    now = do(playback, Train(600))
    assert now.timeline.furthest is None
    for step in (200, 400):
        furthest = do(playback, GoTo(step)).timeline.furthest
        assert furthest is not None
        assert furthest.counters.step == 600
        assert furthest.counters.episodes == now.counters.episodes
        assert furthest.results.curve.return_mean.tobytes() == now.results.curve.return_mean.tobytes()
    further = do(playback, GoTo(600), Train(100), GoTo(650)).timeline.furthest
    assert further is not None
    assert further.counters.step == 700
    forked = do(playback, Apply(SetParameter("alpha", 0.5)))
    assert forked.timeline.furthest is None
    back = do(playback, ChooseBranch(0)).timeline.furthest
    assert back is not None
    assert back.counters.step == 700
