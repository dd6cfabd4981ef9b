"""Going back, forking, lanes: whatever was done, what stands there is what the journal says, bit for bit."""

from __future__ import annotations

from dataclasses import fields, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from recipes import bandit, recipe

from rl_tui.agents.hyperparameters import SAMPLE_AVERAGE
from rl_tui.lab.checkpoints import MOST, MOST_LEFT, Checkpoints
from rl_tui.lab.commands import (
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
    Restart,
    RunEpisode,
    RunUntil,
    Step,
    StepBack,
    Take,
    ToggleBreakpoint,
    Train,
)
from rl_tui.lab.limits import USUAL
from rl_tui.lab.playback import Playback
from rl_tui.lab.recipe import Recipe, SetParameter, SwitchAlgorithm, TakeAction
from rl_tui.lab.record import Record
from rl_tui.lab.run import Run, replay
from rl_tui.lab.session import encoded, read_session
from rl_tui.lab.snapshot import Phase, Snapshot
from rl_tui.lab.table_samples import TableSamples
from rl_tui.lab.until import Breakpoints, Event, Until


class Ticking:
    """A clock on which everything takes a while, so that checkpoints are many and journeys go in pieces."""

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        self.now += 0.02
        return self.now


def begin(made_from: Recipe, record: Record | None = None) -> Playback:
    playback = Playback(
        made_from, speed=None, automatic=False, clock=Ticking(), on_exact=lambda: None, record=record
    )
    while playback.on_the_way:
        playback.work()
    return playback


def do(playback: Playback, *commands: Command) -> Snapshot:
    for command in commands:
        assert playback.takes(command)
        playback.handle(command)
        while playback.on_the_way:
            playback.work()
    return playback.snapshot()


def bits(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return (value.dtype.str, value.tobytes())
    if hasattr(value, "__dataclass_fields__"):
        return [bits(getattr(value, each.name)) for each in fields(value)]
    return [bits(each) for each in value] if isinstance(value, (tuple, list)) else value


def stand(run: Run) -> Any:
    """All that a run knows."""
    learner = run.learner
    known = [learner.q, learner.visits, learner.last_step, learner.rewards, learner.discounted_return]
    known += [run.history.curve(), run.marks, run.history.return_last_100, run.history.length_last_100]
    known += [learner.algorithm, learner.hyperparameters, learner.state, learner.episode_return, run.journal]
    known += [str(each.bit_generator.state) for each in learner.streams]
    return bits([*known, run.step, learner.episodes, learner.episode_step, run.stop_reason, run.over])


def assert_true_to_the_record(playback: Playback) -> None:
    """Every lane stands as the straight replay of its recipe and journal does."""
    record = playback.record
    for number, lane in enumerate(record.lanes):
        playback.handle(ChooseLane(number))
        branch = lane.branches[lane.branch]
        straight = Run(lane.recipe, episode_limit=playback._run.world.budget)
        straight.follow(branch.journal, branch.here)
        assert stand(playback._run) == stand(straight)
    playback.handle(ChooseLane(record.shown))


def through_a_file(record: Record) -> Record:
    """What a session file makes of ``record``."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "session.json"
        path.write_bytes(encoded(record))
        return read_session(path).record()


SETTINGS = st.one_of(
    st.builds(SetParameter, st.just("alpha"), st.sampled_from([0.05, 0.5, SAMPLE_AVERAGE])),
    st.builds(SetParameter, st.just("epsilon"), st.sampled_from([0.0, 0.3, 1.0])),
    st.builds(SetParameter, st.just("gamma"), st.sampled_from([0.0, 0.5, 0.95])),
    st.builds(SetParameter, st.just("ties"), st.sampled_from(["random", "first"])),
    # each loop costs some seconds to compile: of the dearer ones only one that waits, and a planner
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
    st.builds(ChooseLane, st.integers(0, 3)),
    st.builds(DropLane, st.integers(0, 3)),
    st.just("save and load"),
)


@settings(max_examples=60, deadline=None)
@given(
    st.sampled_from(["student", "frozenlake-slippery", "bandit-drifting"]), st.lists(COMMANDS, max_size=14)
)
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
        assert looks(do(playback, GoTo(then.step))) == looks(then)
    for then in moments[1:]:
        assert looks(do(playback, Step())) == looks(then)
    assert len(playback.record.lanes[0].branches) == 1


def looks(snapshot: Snapshot) -> Any:
    """What a snapshot shows, but for what tells of other times."""
    about_now = {"timeline", "handled", "world", "exact"}
    return [bits(getattr(snapshot, each.name)) for each in fields(snapshot) if each.name not in about_now]


def test_playing_on_from_the_past_repeats_history_without_a_fork() -> None:
    playback = begin(recipe("frozenlake-slippery"))
    do(playback, Train(500), Apply(SetParameter("alpha", 0.5)), Train(500), Take(2), Train(499))
    end = stand(playback._run)
    shown = do(playback, GoTo(100))
    assert (shown.hyperparameters.alpha, shown.timeline.in_past) == (0.1, True)
    shown = do(playback, Train(1400))
    assert stand(playback._run) == end
    assert len(shown.timeline.branches) == 1
    assert not shown.timeline.in_past


def test_a_change_in_the_past_forks_and_one_can_go_back_to_either() -> None:
    playback = begin(recipe("frozenlake-slippery"))
    do(playback, Train(1000))
    first = stand(playback._run)
    shown = do(playback, GoTo(400), Apply(SetParameter("alpha", 0.5)), Train(100))
    second = stand(playback._run)
    branch = shown.timeline.current
    assert (branch.name, branch.parent, branch.fork, branch.end) == ("branch 2", 0, 400, 500)
    shown = do(playback, ChooseBranch(0))
    assert (shown.step, shown.timeline.current.end) == (400, 1000)  # where it was left
    do(playback, GoTo(1000))
    assert stand(playback._run) == first
    shown = do(playback, ChooseBranch(1))
    assert stand(playback._run) == second
    assert shown.hyperparameters.alpha == 0.5


def test_a_change_at_the_very_end_is_no_fork() -> None:
    playback = begin(recipe("student"))
    shown = do(playback, Train(50), Apply(SetParameter("alpha", 0.5)), Train(1), StepBack())
    assert len(shown.timeline.branches) == 1
    assert shown.hyperparameters.alpha == 0.5  # what was set at step 50 is in force there


def test_what_was_set_at_a_step_is_in_force_there_however_one_comes_to_it() -> None:
    playback = begin(recipe("student"))
    do(playback, Apply(SetParameter("alpha", 0.9)))
    for number in range(1, 13):
        do(playback, Step(), Apply(SetParameter("alpha", number / 100)))
    do(playback, Step())
    for number in range(1, 13):
        shown = do(playback, GoTo(number))
        assert (shown.hyperparameters.alpha, len(playback._run.journal)) == (number / 100, number + 1)
    assert do(playback, GoTo(0)).hyperparameters.alpha == 0.9
    saved = playback.record
    assert begin(saved.lanes[0].recipe, saved).snapshot().hyperparameters.alpha == 0.9


def test_back_by_steps_and_episodes() -> None:
    playback = begin(recipe("frozenlake"))
    shown = do(playback, RunEpisode(), RunEpisode(), Step(), Step())
    here = shown.step
    assert do(playback, StepBack()).step == here - 1
    assert do(playback, StepBack(), StepBack(), StepBack()).step == here - 4
    shown = do(playback, GoTo(here), EpisodeBack())
    assert (shown.step, shown.episodes) == (here - 2, 2)
    shown = do(playback, EpisodeBack())
    assert (shown.episodes, shown.episode_step, shown.phase) == (1, 0, Phase.PAUSED)
    assert do(playback, EpisodeBack(), EpisodeBack(), EpisodeBack(), StepBack()).step == 0


def test_an_episode_is_gone_to_by_its_number() -> None:
    playback = begin(recipe("frozenlake-slippery"))
    do(playback, Train(5_000))
    shown = do(playback, GoTo(episode=7))
    assert (shown.episodes, shown.episode_step) == (6, 0)
    assert do(playback, GoTo(episode=10**9)).step == 5_000
    assert do(playback, GoTo(step=10**12)).step == 5_000
    assert do(playback, GoTo(step=-3)).step == 0


def test_an_episode_that_a_planner_cut_short_begins_where_the_one_before_ended() -> None:
    playback = begin(recipe("frozenlake-slippery"))
    shown = do(playback, RunEpisode(), Step(), Step())
    here = shown.step - 2
    do(playback, Apply(SwitchAlgorithm("value-iteration")), Train(5))
    for _ in range(2):
        assert do(playback, GoTo(here + 7), EpisodeBack()).step == here
    assert do(playback, GoTo(here + 2), EpisodeBack()).step == here
    assert do(playback, GoTo(here + 3), GoTo(episode=2)).step == here
    assert do(playback, EpisodeBack()).step == 0


def test_time_travel_of_a_planner() -> None:
    playback = begin(recipe("frozenlake-slippery", algorithm="value-iteration"))
    shown = do(playback, Train(100_000))
    assert shown.phase is Phase.DONE
    end = shown.step
    shown = do(playback, StepBack())
    assert (shown.step, shown.phase) == (end - 1, Phase.PAUSED)
    shown = do(playback, EpisodeBack())
    assert shown.episode_step == 0
    shown = do(playback, Play(), Pause(), Train(100_000))
    assert (shown.step, shown.phase) == (end, Phase.DONE)


def test_a_spent_budget_can_be_taken_back() -> None:
    playback = begin(bandit(50))
    assert do(playback, Train(1000)).phase is Phase.SPENT
    shown = do(playback, StepBack())
    assert (shown.step, shown.phase) == (49, Phase.PAUSED)
    assert do(playback, Step()).phase is Phase.SPENT


@pytest.mark.parametrize("scenario", ["blackjack", "cartpole"])
def test_a_stepped_world_is_replayed_from_the_seed(scenario: str) -> None:
    playback = begin(recipe(scenario))
    do(playback, Train(300), Apply(SetParameter("epsilon", 0.9)), Train(300))
    end = stand(playback._run)
    shown = do(playback, StepBack())
    assert shown.step == 599
    do(playback, Step())
    assert stand(playback._run) == end
    playback.handle(GoTo(200))
    assert playback.phase is Phase.SEEKING
    assert "from the seed" in playback.snapshot().message
    assert playback.snapshot().step == 600  # the old moment is shown until the new one is there
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
    assert playback.record.lanes[0].step == 999  # where a session would come back to
    playback.work()
    playback.handle(Pause())
    assert (playback.phase, playback.snapshot().step) == (Phase.PAUSED, 3000)


def test_lanes_follow_to_the_same_step_and_are_runs_of_their_own() -> None:
    playback = begin(recipe("frozenlake-slippery"))
    do(playback, Train(1000), Apply(SetParameter("gamma", 0.9)), Take(1))
    shown = do(playback, AddLane((SetParameter("alpha", 0.5),)))
    assert [lane.step for lane in shown.lanes] == [1001, 1001]
    assert shown.lane == 0
    shown = do(playback, Train(500), ChooseLane(1))
    assert [lane.step for lane in shown.lanes] == [1501, 1501]
    assert (shown.hyperparameters.alpha, shown.hyperparameters.gamma) == (0.5, 0.9)
    assert shown.timeline.current.journal == playback.record.lanes[1].branches[0].journal
    assert all(not isinstance(each.change, TakeAction) for each in shown.timeline.current.journal)
    shown = do(playback, GoTo(200), Apply(SetParameter("epsilon", 0.0)), Train(100))
    assert [lane.step for lane in shown.lanes] == [300, 300]
    assert [len(each.branches) for each in playback.record.lanes] == [1, 2]
    assert_true_to_the_record(playback)
    shown = do(playback, DropLane(0))
    assert shown.lanes == ()
    assert shown.hyperparameters.alpha == 0.5


def test_a_lane_that_is_over_waits_while_others_go_on() -> None:
    playback = begin(recipe("frozenlake-slippery"))
    do(playback, Train(100), AddLane((SwitchAlgorithm("value-iteration"),)))
    shown = do(playback, Train(20_000))
    steps = [lane.step for lane in shown.lanes]
    assert steps[0] == 20_100 > steps[1]
    shown = do(playback, ChooseLane(1))
    assert shown.phase is Phase.DONE
    assert [lane.step for lane in shown.lanes] == steps
    shown = do(playback, ChooseLane(0), GoTo(50))
    assert [lane.step for lane in shown.lanes] == [50, 50]


def test_lanes_come_back_where_they_stood_though_the_one_shown_is_over() -> None:
    playback = begin(recipe("frozenlake-slippery", algorithm="value-iteration"))
    do(playback, AddLane((SwitchAlgorithm("q-learning"),)), Train(20_000), ChooseLane(1), Train(20_000))
    shown = do(playback, ChooseLane(0))
    assert shown.phase is Phase.DONE
    assert shown.lanes[0].step < shown.lanes[1].step
    saved = playback.record
    assert begin(saved.lanes[0].recipe, saved).record == saved
    # with another discount it goes on, and leads again
    shown = do(playback, Apply(SetParameter("gamma", 0.5)))
    assert shown.phase is Phase.PAUSED
    assert shown.lanes[0].step == shown.lanes[1].step
    assert_true_to_the_record(playback)


def test_a_lane_that_takes_long_to_catch_up_can_be_dropped_or_left_behind() -> None:
    playback = Playback(
        recipe("blackjack"), speed=None, automatic=True, clock=Ticking(), on_exact=lambda: None
    )

    def settle() -> Snapshot:
        while playback.on_the_way:
            playback.work()
        return playback.snapshot()

    settle()
    playback.handle(Train(3000))
    settle()
    playback.handle(Play())
    playback.handle(AddLane((SetParameter("alpha", 0.5),)))
    assert (playback.phase, playback.takes(Step())) == (Phase.SEEKING, False)
    playback.handle(Pause())
    assert playback.takes(StepBack())
    assert playback.takes(DropLane(1))
    playback.handle(DropLane(1))
    shown = playback.snapshot()
    assert (shown.phase, shown.step, shown.lanes) == (Phase.PAUSED, 3000, ())
    playback.handle(AddLane((SetParameter("alpha", 0.5),)))
    playback.handle(GoTo(40))
    assert [lane.step for lane in settle().lanes] == [40, 40]
    assert_true_to_the_record(playback)


def test_there_are_four_lanes_at_most_and_they_must_be_able_to_work() -> None:
    playback = begin(recipe("frozenlake"))
    for alpha in (0.2, 0.3, 0.4):
        do(playback, AddLane((SetParameter("alpha", alpha),)))
    assert "4 lanes" in do(playback, AddLane((SetParameter("alpha", 0.5),))).paused_by
    playback = begin(recipe("frozenlake"))
    shown = do(playback, AddLane((SetParameter("policy", "thompson"),)))
    assert shown.paused_by
    assert shown.lanes == ()


def test_restarting_begins_every_lane_anew() -> None:
    playback = begin(recipe("frozenlake"))
    shown = do(playback, Train(300), AddLane((SetParameter("alpha", 0.5),)), ToggleBreakpoint(state=6))
    shown = do(playback, Restart(replace(shown.recipe, seed=3)))
    assert [(lane.step, lane.hyperparameters.alpha) for lane in shown.lanes] == [(0, 0.1), (0, 0.5)]
    assert {each.recipe.seed for each in playback.record.lanes} == {3}
    assert shown.breakpoints == Breakpoints(frozenset({6}))


def test_a_run_pauses_at_breakpoints_and_at_what_was_waited_for() -> None:
    playback = begin(recipe("frozenlake-slippery"))
    shown = do(playback, RunUntil(Until(Event.REWARD)))
    assert shown.last is not None
    assert (shown.last.reward, shown.paused_by) == (1.0, "the next reward")
    straight = replay(shown.recipe, (), shown.step - 1)
    assert straight.learner.visits.sum() == shown.step - 1
    assert straight.history.total_return == 0.0
    shown = do(playback, GoTo(0), ToggleBreakpoint(state=9), RunUntil(Until(Event.STEP, 10_000)))
    assert shown.paused_by == "breakpoint: state 9"
    assert shown.state == 9
    shown = do(playback, ClearBreakpoints(), RunUntil(Until(Event.STEP, 10_000)))
    assert (shown.step, shown.paused_by) == (10_000, "step 10,000")
    assert "lies behind" in do(playback, RunUntil(Until(Event.STEP, 10))).paused_by
    shown = do(playback, RunUntil(Until(Event.EPISODE, 1500)))
    assert (shown.episodes, shown.episode_step) == (1499, 0)
    shown = do(playback, GoTo(0), RunUntil(Until(Event.VALUE, pair=0, threshold=0.1)))
    assert shown.q[0] >= 0.1
    assert replay(shown.recipe, (), shown.step - 1).learner.q[0] < 0.1


def test_the_first_moment_the_policy_is_optimal() -> None:
    playback = begin(recipe("student"))
    shown = do(playback, RunUntil(Until(Event.OPTIMAL)))
    assert shown.paused_by
    assert shown.exact is not None
    assert shown.greedy_return == pytest.approx(shown.exact.expected_return)
    before = do(playback, StepBack())
    assert before.greedy_return != pytest.approx(shown.exact.expected_return)
    assert "already" in do(playback, Step(), RunUntil(Until(Event.OPTIMAL))).paused_by
    assert "optimal" in do(begin(recipe("cartpole")), RunUntil(Until(Event.OPTIMAL))).paused_by


def test_the_best_arm_is_looked_for_where_it_drifts_to() -> None:
    playback = begin(recipe("bandit-drifting", seed=1))

    def is_best(shown: Snapshot) -> bool:
        assert shown.exact is not None
        return bool(shown.exact.greedy[int(shown.q.argmax())])

    assert not is_best(do(playback, Train(20)))
    shown = do(playback, RunUntil(Until(Event.OPTIMAL)))
    assert is_best(shown)
    assert not any(is_best(do(playback, GoTo(step))) for step in range(20, shown.step))


def test_a_breakpoint_is_met_in_the_past_though_something_is_set_there() -> None:
    playback = begin(recipe("frozenlake-slippery"))
    do(playback, ToggleBreakpoint(state=4))
    shown = do(playback, RunUntil(Until(Event.STEP, 1000)))
    assert shown.paused_by == "breakpoint: state 4"
    shown = do(playback, Apply(SetParameter("ties", "first")), Train(10), GoTo(0))
    again = do(playback, RunUntil(Until(Event.STEP, 1000)))
    assert again.paused_by == "breakpoint: state 4"
    assert again.hyperparameters.ties == "first"


def test_what_cannot_be_done_is_told_and_ends_nothing() -> None:
    playback = begin(recipe("frozenlake"))
    for command in (ChooseBranch(3), ChooseBranch(-1), Apply(SetParameter("alpha", 7.0)), Take(9)):
        assert do(playback, command).paused_by
    assert do(playback, Step()).step == 1


def test_an_action_that_is_not_possible_is_refused() -> None:
    playback = begin(recipe("student"))
    before = stand(playback._run)
    shown = do(playback, Take(4))
    assert shown.paused_by == "sleep is not possible in state Class"
    assert stand(playback._run) == before
    assert playback.record.lanes[0].branches[0].journal == ()


def test_the_history_of_a_cell_is_what_it_was() -> None:
    playback = begin(recipe("frozenlake-slippery"))
    shown = do(playback, Train(5_000), FollowCell(3))
    assert shown.cell is not None
    assert (shown.cell.pair, len(shown.cell.step)) == (3, len(shown.cell.value))
    assert 100 < len(shown.cell.step) <= 257
    for step, value in zip(shown.cell.step.tolist()[::20], shown.cell.value.tolist()[::20], strict=True):
        assert replay(shown.recipe, (), step).learner.q[3] == value
    shown = do(playback, GoTo(777))
    assert shown.cell is not None
    assert (shown.cell.step[0], shown.cell.step[-1], shown.cell.value[-1]) == (0, 777, shown.q[3])
    shown = do(playback, Apply(SetParameter("alpha", 0.9)), Train(20_000))
    assert shown.cell is not None
    assert shown.cell.value[-1] == shown.q[3]
    straight = replay(shown.recipe, shown.timeline.current.journal, int(shown.cell.step[-3]))
    assert straight.learner.q[3] == shown.cell.value[-3]


def test_a_mark_is_taken_after_a_step_by_hand_as_after_any_other() -> None:
    by_hand = do(begin(recipe("frozenlake")), *(Take(1) for _ in range(16)))
    assert by_hand.marks.step.tolist() == [0, 16]


def test_steps_by_hand_do_not_stop_the_history_of_cells() -> None:
    playback = begin(recipe("frozenlake"))
    shown = do(playback, *(Take(1) for _ in range(5)), FollowCell(1), Train(50))
    assert shown.cell is not None
    assert shown.cell.step.tolist() == list(range(56))


def test_samples_keep_within_their_bounds() -> None:
    samples = TableSamples(4)
    for step in range(5_000):
        if samples.next_step == step:
            samples.add(np.full(4, float(step)))
    history = samples.history(2, 4_999, np.full(4, -1.0))
    assert len(history.step) <= 257
    assert history.step[:-1].tolist() == history.value[:-1].tolist()
    assert set(np.diff(history.step[:-1]).tolist()) == {32}
    assert TableSamples(10**6).next_step is None


def test_checkpoints_keep_within_their_bounds() -> None:
    run, kept = Run(recipe("frozenlake")), Checkpoints()
    for _ in range(3 * MOST):
        run.advance(steps=3)
        kept.add(run.checkpoint())
    assert MOST // 2 < len(kept) <= MOST
    found = kept.before_step(1000)
    assert found is not None
    assert 1000 - 3 * 16 < found.step <= 1000
    assert kept.before_step(0) is None
    one, many = kept.up_to(10**9, 0), kept.up_to(10**9, 0)
    one.thin_out(1)
    many.thin_out(2_000)
    assert 1 <= len(many) < len(one) <= MOST_LEFT
    assert many.nbytes <= USUAL.checkpoints_left // 2_000


def test_passing_by_the_same_moments_again_and_again_keeps_no_more_of_them() -> None:
    playback = begin(recipe("frozenlake-slippery"))
    do(playback, Train(2_000))
    kept = playback._lanes.current._way.checkpoints
    spacing = kept.spacing
    for _ in range(10):
        do(playback, GoTo(0), Train(500))
    assert kept.spacing == spacing
