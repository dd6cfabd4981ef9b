"""Ordered sweeps are part of a run."""

from __future__ import annotations

import json
import shlex
from dataclasses import replace
from pathlib import Path

import pytest
from click.testing import CliRunner
from playing import assert_true_to_the_record, begin, do, stand
from recipes import bandit, recipe, replay
from session_samples import after, fresh

from rl_tui.commands.main import program
from rl_tui.common.errors import UserError
from rl_tui.live.commands import (
    AddLane,
    Apply,
    ChooseBranch,
    Command,
    EpisodeBack,
    GoTo,
    RunSweep,
    Step,
    StepBack,
    Train,
)
from rl_tui.live.playback import Playback
from rl_tui.live.sessions.session import encoded, read_session
from rl_tui.live.snapshot import Phase, Snapshot
from rl_tui.runs.changes import as_json, journal_of, read_change, written_change
from rl_tui.runs.export.recipe_line import recipe_line
from rl_tui.runs.recipe import JournalEntry, OrderSweep, SetParameter, SwitchAlgorithm
from rl_tui.runs.run import Run

EVALUATE, IMPROVE = RunSweep("evaluation"), RunSweep("improvement")
EVALUATION, IMPROVEMENT = OrderSweep("evaluation"), OrderSweep("improvement")
MADE_FROM = recipe("frozenlake-slippery", algorithm="policy-iteration")
STATES = 11
JOURNAL = (JournalEntry(0, EVALUATION), JournalEntry(11, IMPROVEMENT), JournalEntry(30, IMPROVEMENT))


def planning(*commands: Command) -> tuple[Playback, Snapshot]:
    playback = begin(MADE_FROM)
    return playback, do(playback, *commands)


def changes(shown: Snapshot) -> list[tuple[int, object]]:
    return [(entry.step, entry.change) for entry in shown.timeline.current.journal]


def test_a_sweep_is_run_to_its_end_and_no_further() -> None:
    playback, shown = planning(EVALUATE)
    assert (shown.counters.step, shown.counters.episodes, shown.agent.sweep) == (STATES, 1, "evaluation")
    shown = do(playback, IMPROVE)
    assert (shown.counters.step, shown.counters.episodes, shown.agent.sweep) == (2 * STATES, 2, "improvement")
    assert shown.playback.phase is Phase.PAUSED
    assert shown.playback.paused_by == ""
    assert changes(shown) == [(0, EVALUATION), (STATES, IMPROVEMENT)]
    assert_true_to_the_record(playback)


def test_in_the_middle_of_a_sweep_of_that_kind_it_is_finished_and_nothing_is_ordered() -> None:
    _, shown = planning(Step(), Step(), EVALUATE)
    assert (shown.counters.episodes, shown.agent.sweep, changes(shown)) == (1, "evaluation", [])


def test_in_the_middle_of_another_that_is_finished_first() -> None:
    playback, shown = planning(Step(), Step(), IMPROVE)
    assert (shown.counters.episodes, shown.agent.sweep) == (2, "improvement")
    assert changes(shown) == [(2, IMPROVEMENT)]
    assert_true_to_the_record(playback)


def test_the_policy_of_a_snapshot_changes_with_improvements_only() -> None:
    playback, shown = planning(EVALUATE, EVALUATE)
    assert set(shown.agent.policy.tolist()) == {0.25}
    before = shown.agent.values
    shown = do(playback, IMPROVE)
    assert shown.agent.values.tobytes() == before.tobytes()
    assert 0.5 in shown.agent.policy.tolist()
    shown = do(playback, Apply(SwitchAlgorithm("value-iteration")))
    assert (len(shown.agent.policy), shown.agent.sweep) == (0, None)


def test_what_was_done_is_done_again_on_the_way_back_and_on() -> None:
    playback, shown = planning(EVALUATE, EVALUATE, IMPROVE, EVALUATE, IMPROVE)
    bits = stand(playback.group.current.run)
    for back in (StepBack(), EpisodeBack(), GoTo(step=13), GoTo(step=0)):
        do(playback, back)
        assert_true_to_the_record(playback)
        do(playback, GoTo(step=shown.counters.step))
        assert stand(playback.group.current.run) == bits
    assert len(playback.record.lanes[0].branches) == 1


def test_the_same_order_again_on_the_way_stays_on_the_branch_another_begins_one() -> None:
    playback, _ = planning(EVALUATE, IMPROVE, EVALUATE)
    shown = do(playback, GoTo(step=STATES), IMPROVE)
    assert (shown.counters.step, len(shown.timeline.branches)) == (2 * STATES, 1)
    shown = do(playback, GoTo(step=STATES), EVALUATE)
    assert (shown.agent.sweep, len(shown.timeline.branches)) == ("evaluation", 2)
    assert_true_to_the_record(playback)
    shown = do(playback, ChooseBranch(0))
    assert (shown.counters.step, shown.agent.sweep) == (2 * STATES, "improvement")


def test_a_planner_that_is_done_goes_on_with_what_is_ordered() -> None:
    playback, shown = planning(Train(10**6))
    assert shown.playback.phase is Phase.DONE
    end = shown.counters.step
    shown = do(playback, EVALUATE)
    assert (shown.playback.phase, shown.counters.step) == (Phase.PAUSED, end + STATES)
    shown = do(playback, IMPROVE)
    assert (shown.playback.phase, shown.counters.step) == (Phase.DONE, end + 2 * STATES)
    assert_true_to_the_record(playback)


@pytest.mark.parametrize("algorithm", ["q-learning", "value-iteration"])
def test_others_take_no_orders_and_say_so(algorithm: str) -> None:
    playback = begin(recipe("frozenlake", algorithm=algorithm))
    shown = do(playback, EVALUATE)
    assert "choose policy-iteration" in shown.playback.paused_by
    assert (shown.counters.step, changes(shown)) == (0, [])


def test_a_run_that_is_over_takes_no_orders() -> None:
    run = Run(bandit(budget=5), evaluate=False, episode_limit=5)
    run.advance()
    run.apply(SwitchAlgorithm("policy-iteration"))
    with pytest.raises(UserError, match="the run is over: no sweep can be run"):
        run.apply(EVALUATION)


def test_a_lane_has_the_orders_of_the_one_shown_unless_another_algorithm_is_at_work() -> None:
    playback, _ = planning(EVALUATE, IMPROVE)
    do(playback, AddLane((SetParameter("gamma", 0.5),)), AddLane((SwitchAlgorithm("q-learning"),)))
    do(playback, EVALUATE)
    journals = [lane.branches[0].journal for lane in playback.record.lanes]
    assert [len(each) for each in journals] == [3, 2, 0]
    assert_true_to_the_record(playback)


def test_a_lane_that_leads_alone_is_given_orders() -> None:
    playback, _ = planning(AddLane((SetParameter("gamma", 0.5),)))
    shown = do(playback, EVALUATE)
    assert [lane.step for lane in shown.run_group.lanes] == [STATES, STATES]
    assert [len(lane.branches[0].journal) for lane in playback.record.lanes] == [1, 0]


@pytest.mark.parametrize("entry", JOURNAL)
def test_an_order_is_read_as_it_is_written(entry: JournalEntry) -> None:
    assert written_change(entry, ()) == f"{entry.step}:sweep={entry.change.phase}"
    assert journal_of([read_change(written_change(entry, ()))], ()) == (entry,)
    assert as_json([entry], ())[0]["name"] == "sweep"


@pytest.mark.parametrize(
    ("text", "fault"),
    [("5:sweep=both", "expected evaluation or improvement"), ("5:swep=evaluation", 'did you mean "sweep"')],
)
def test_faults_say_what_was_expected(text: str, fault: str) -> None:
    with pytest.raises(ValueError, match=fault):
        read_change(text)


def test_a_session_keeps_them(tmp_path: Path) -> None:
    record = after(fresh(MADE_FROM), 40, *((entry.step, entry.change) for entry in JOURNAL))
    path = tmp_path / "a.json"
    path.write_bytes(encoded(record))
    (stored,) = (lane.branches[0].journal for lane in read_session(path).record().lanes)
    assert stored == JOURNAL
    playback = begin(MADE_FROM, record)
    assert stand(playback.group.current.run) == stand(replay(MADE_FROM, JOURNAL, 40))


def test_a_session_with_another_sweep_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    text = encoded(after(fresh(MADE_FROM), 40, (3, EVALUATION))).replace(b'"evaluation"', b'"revaluation"')
    path.write_bytes(text)
    with pytest.raises(UserError):
        read_session(path)


def test_the_line_does_it_again() -> None:
    run = replay(MADE_FROM, JOURNAL, 60)
    line = recipe_line(MADE_FROM, run.journal, run.step, run.world.space.action_names)
    assert line.count("--change") == 3
    result = CliRunner().invoke(program, [*shlex.split(line)[1:], "--json"])
    assert (result.exit_code, result.stderr) == (0, "")
    printed = json.loads(result.stdout)
    assert printed["steps"] == 60
    assert [each["value"] for each in printed["journal"]] == ["evaluation", "improvement", "improvement"]


def test_of_two_orders_of_one_step_the_line_has_the_last() -> None:
    both = [JournalEntry(11, EVALUATION), JournalEntry(11, IMPROVEMENT)]
    assert recipe_line(MADE_FROM, both, 20, ()).count("--change") == 1
    alone = replay(MADE_FROM, both[1:], 20)
    assert alone.learner.q.tobytes() == replay(MADE_FROM, both, 20).learner.q.tobytes()


def test_training_goes_on_where_it_was_ordered_to_after_it_was_done(tmp_path: Path) -> None:
    run = Run(MADE_FROM)
    run.advance()
    end = run.step
    words = ["train", "frozenlake-slippery", "--algorithm", "policy-iteration", "--json"]
    words += ["--change", f"{end}:sweep=evaluation", "--steps", str(end + 5)]
    result = CliRunner().invoke(program, words)
    assert (result.exit_code, result.stderr) == (0, "")
    assert json.loads(result.stdout)["steps"] == end + 5


def test_training_refuses_an_order_to_another_algorithm() -> None:
    result = CliRunner().invoke(
        program, ["train", "student", "--change", "5:sweep=evaluation", "--steps", "9"]
    )
    assert result.exit_code == 1
    assert "Q-learning has no separate evaluation and improvement: choose policy-iteration" in result.stderr


def test_how_it_is_cut_makes_no_difference() -> None:
    straight = replay(MADE_FROM, JOURNAL, 60)
    pieces = Run(MADE_FROM)
    for step in (1, 11, 12, 29, 31, 60):
        pieces.follow(JOURNAL, step)
    assert stand(pieces) == stand(straight)
    again = Run(replace(MADE_FROM))
    again.follow(JOURNAL, 33)
    other = Run(MADE_FROM)
    other.restore(again.checkpoint())
    other.follow(JOURNAL, 60)
    assert stand(other) == stand(straight)
