"""Several runs at once."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from playing import Ticking, assert_true_to_the_record, begin, do, stand
from recipes import recipe

from rl_tui.live.commands import (
    AddLane,
    Apply,
    ChooseLane,
    DropLane,
    GoTo,
    Pause,
    Play,
    Restart,
    Step,
    StepBack,
    Take,
    ToggleBreakpoint,
    Train,
)
from rl_tui.live.pace.until import Breakpoints
from rl_tui.live.playback import Playback
from rl_tui.live.sessions.session import encoded, read_session
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.runs.recipe import SEED_DRAWS_WORLD, SetParameter, SwitchAlgorithm, TakeAction


def test_lanes_follow_to_the_same_step_and_are_runs_of_their_own() -> None:
    playback = begin(recipe("frozenlake-slippery"))
    do(playback, Train(1000), Apply(SetParameter("gamma", 0.9)), Take(1))
    shown = do(playback, AddLane((SetParameter("alpha", 0.5),)))
    assert [lane.step for lane in shown.run_group.lanes] == [1001, 1001]
    assert shown.run_group.shown == 0
    shown = do(playback, Train(500), ChooseLane(1))
    assert [lane.step for lane in shown.run_group.lanes] == [1501, 1501]
    assert (shown.agent.hyperparameters.alpha, shown.agent.hyperparameters.gamma) == (0.5, 0.9)
    assert shown.timeline.current.journal == playback.record.lanes[1].branches[0].journal
    assert all(not isinstance(each.change, TakeAction) for each in shown.timeline.current.journal)
    shown = do(playback, GoTo(200), Apply(SetParameter("epsilon", 0.0)), Train(100))
    assert [lane.step for lane in shown.run_group.lanes] == [300, 300]
    assert [len(each.branches) for each in playback.record.lanes] == [1, 2]
    assert_true_to_the_record(playback)
    shown = do(playback, DropLane(0))
    assert shown.run_group.lanes == ()
    assert shown.agent.hyperparameters.alpha == 0.5


def test_a_lane_that_is_over_waits_while_others_go_on() -> None:
    playback = begin(recipe("frozenlake-slippery"))
    do(playback, Train(100), AddLane((SwitchAlgorithm("value-iteration"),)))
    shown = do(playback, Train(5_000))
    steps = [lane.step for lane in shown.run_group.lanes]
    assert steps[0] == 5_100 > steps[1]
    shown = do(playback, ChooseLane(1))
    assert shown.playback.phase is Phase.DONE
    assert [lane.step for lane in shown.run_group.lanes] == steps
    shown = do(playback, ChooseLane(0), GoTo(50))
    assert [lane.step for lane in shown.run_group.lanes] == [50, 50]


@pytest.mark.slow
def test_lanes_come_back_where_they_stood_though_the_one_shown_is_over() -> None:
    playback = begin(recipe("frozenlake-slippery", algorithm="value-iteration"))
    do(playback, AddLane((SwitchAlgorithm("q-learning"),)), Train(5_000), ChooseLane(1), Train(5_000))
    shown = do(playback, ChooseLane(0))
    assert shown.playback.phase is Phase.DONE
    assert shown.run_group.lanes[0].step < shown.run_group.lanes[1].step
    saved = playback.record
    assert begin(saved.lanes[0].recipe, saved).record == saved
    # with another discount it continues, and is controlled again
    shown = do(playback, Apply(SetParameter("gamma", 0.5)))
    assert shown.playback.phase is Phase.PAUSED
    assert shown.run_group.lanes[0].step == shown.run_group.lanes[1].step
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
    assert (shown.playback.phase, shown.counters.step, shown.run_group.lanes) == (Phase.PAUSED, 3000, ())
    playback.handle(AddLane((SetParameter("alpha", 0.5),)))
    playback.handle(GoTo(40))
    assert [lane.step for lane in settle().run_group.lanes] == [40, 40]
    assert_true_to_the_record(playback)


def test_there_are_four_lanes_at_most_and_they_must_be_able_to_work() -> None:
    playback = begin(recipe("frozenlake"))
    for alpha in (0.2, 0.3, 0.4):
        do(playback, AddLane((SetParameter("alpha", alpha),)))
    assert "4 runs" in do(playback, AddLane((SetParameter("alpha", 0.5),))).playback.paused_by
    playback = begin(recipe("frozenlake"))
    shown = do(playback, AddLane((SetParameter("policy", "thompson"),)))
    assert shown.playback.paused_by
    assert shown.run_group.lanes == ()


def test_a_run_with_another_seed_is_the_run_of_that_seed_and_comes_back_from_its_file(tmp_path: Path) -> None:
    made_from = recipe("frozenlake-slippery")
    playback = begin(made_from)
    do(playback, Train(400), Apply(SetParameter("alpha", 0.3)), Take(1), AddLane(next_seed=True))
    shown = do(playback, Train(600), ChooseLane(1))
    assert [lane.name for lane in shown.run_group.lanes] == ["seed 0", "seed 1"]
    assert shown.recipe == replace(made_from, seed=1)
    assert_true_to_the_record(playback)
    do(playback, GoTo(200), Apply(SetParameter("epsilon", 0.0)), Train(100))
    assert_true_to_the_record(playback)
    path = tmp_path / "both.json"
    path.write_bytes(encoded(playback.record))
    saved = read_session(path).record()
    assert [each.recipe.seed for each in saved.lanes] == [0, 1]
    resumed = begin(saved.lanes[1].recipe, saved)
    assert stand(resumed.group.current.run) == stand(playback.group.current.run)


@pytest.mark.parametrize(("seed", "seeds"), [(0, [0, 1, 0]), (1, [1, 0, 1]), (5, [5, 1, 5])])
def test_seeds_that_differ_go_on_to_differ_when_all_start_again(seed: int, seeds: list[int]) -> None:
    playback = begin(recipe("frozenlake"))
    shown = do(playback, AddLane(next_seed=True), AddLane((SetParameter("alpha", 0.5),)))
    assert [each.recipe.seed for each in playback.record.lanes] == [0, 1, 0]
    do(playback, Restart(replace(shown.recipe, seed=seed)))
    assert [each.recipe.seed for each in playback.record.lanes] == seeds


def test_runs_with_another_seed_that_are_asked_for_at_once_have_seeds_of_their_own() -> None:
    playback = begin(recipe("frozenlake"))
    do(playback, AddLane(next_seed=True), AddLane(next_seed=True), AddLane(next_seed=True))
    assert [each.recipe.seed for each in playback.record.lanes] == [0, 1, 2, 3]


def test_a_world_that_its_seed_draws_has_no_run_with_another_seed() -> None:
    shown = do(begin(recipe("bandit")), AddLane(next_seed=True))
    assert shown.playback.paused_by == SEED_DRAWS_WORLD
    assert shown.run_group.lanes == ()


def test_restarting_begins_every_lane_anew() -> None:
    playback = begin(recipe("frozenlake"))
    shown = do(playback, Train(300), AddLane((SetParameter("alpha", 0.5),)), ToggleBreakpoint(state=6))
    shown = do(playback, Restart(replace(shown.recipe, seed=3)))
    assert [(lane.step, lane.hyperparameters.alpha) for lane in shown.run_group.lanes] == [(0, 0.1), (0, 0.5)]
    assert {each.recipe.seed for each in playback.record.lanes} == {3}
    assert shown.playback.breakpoints == Breakpoints(frozenset({6}))
