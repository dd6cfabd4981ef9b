"""Two branches of one run, side by side."""

from __future__ import annotations

import pytest
from playing import assert_true_to_the_record, begin, do, stand
from recipes import recipe, replay
from test_going_back import through_a_file

from rl_tui.live.commands import AddBranch, AddLane, Apply, ChooseBranch, ChooseLane, GoTo, Take, Train
from rl_tui.live.playback import Playback
from rl_tui.runs.recipe import (
    EditWorld,
    JournalEntry,
    Recipe,
    SetParameter,
    SwitchAlgorithm,
    TakeAction,
    UndoEdit,
)
from rl_tui.runs.timeline.run_names import LanePast, branch_in_words, lane_names
from rl_tui.worlds.editing.edit import read_edits

EXPLORE = SetParameter("epsilon", 0.3)


def forked(scenario: str = "frozenlake-slippery", **overrides: str) -> Playback:
    """A run that reached step 1,000, then step 701 on a second branch from step 400."""
    playback = begin(recipe(scenario, **overrides))
    do(playback, Train(1000), GoTo(400), Apply(EXPLORE), Train(200), Take(0), Train(100))
    return playback


@pytest.mark.parametrize(
    ("scenario", "algorithm"), [("frozenlake-slippery", "sarsa"), ("bandit-drifting", "q-learning")]
)
def test_at_every_step_the_lane_equals_the_branch(scenario: str, algorithm: str) -> None:
    playback = forked(scenario, algorithm=algorithm)
    journal = playback.record.lanes[0].branches[1].journal
    do(playback, ChooseBranch(0), AddBranch(1))
    group = playback.group
    assert group.beside is not None
    made_from = group.current.recipe
    for step in (701, 0, 399, 400, 401, 600, 601, 700, 702, 1000):
        do(playback, GoTo(step))
        assert group.current.run.step == group.beside.run.step == step
        assert stand(group.beside.run) == stand(replay(made_from, journal, step))
        assert stand(group.current.run) == stand(replay(made_from, (), step))
    do(playback, Train(150))
    assert stand(group.beside.run) == stand(replay(made_from, journal, 1150))


def test_a_branch_comes_to_where_the_run_stands_and_is_marked() -> None:
    playback = forked()
    do(playback, ChooseBranch(0), GoTo(1000), AddLane((SetParameter("alpha", 0.5),)))
    shown = do(playback, AddBranch(1))
    assert [lane.step for lane in shown.run_group.lanes] == [1000, 1000, 1000]
    assert (shown.run_group.shown, shown.run_group.beside) == (0, 2)
    assert [lane.hyperparameters.epsilon for lane in shown.run_group.lanes][1:] == [0.1, 0.3]
    assert_true_to_the_record(playback)


def test_what_is_changed_in_one_is_not_changed_in_the_other() -> None:
    playback = forked()
    before = playback.record.lanes[0]
    do(playback, AddBranch(0), ChooseLane(1), Apply(SetParameter("gamma", 0.5)), Train(50))
    own, other = playback.record.lanes
    assert own.branches[0] == before.branches[0]
    assert own.branches[1].journal == before.branches[1].journal
    # step 701 was in the past of branch 1, so that the run has branched there
    assert [branch.name for branch in other.branches] == ["branch 1", "branch 3"]
    names = [lane.name for lane in playback.snapshot().run_group.lanes]
    assert [name.partition(":")[0] for name in names] == ["branch 2", "branch 3"]
    do(playback, ChooseLane(0), GoTo(500), Apply(SetParameter("alpha", 0.5)))
    assert playback.record.lanes[1].branches[0] == other.branches[0]
    assert_true_to_the_record(playback)


def test_a_branch_that_forks_again_does_so_under_a_new_name() -> None:
    playback = forked()
    do(playback, ChooseBranch(0), AddBranch(1), ChooseLane(1), GoTo(300), Apply(EXPLORE))
    assert [branch.name for branch in playback.record.lanes[1].branches] == ["branch 2", "branch 3"]


def test_a_session_keeps_it() -> None:
    playback = forked()
    do(playback, AddBranch(0), Train(99))
    saved = through_a_file(playback.record)
    again = begin(saved.lanes[0].recipe, saved)
    assert again.record == saved
    assert [stand(each.run) for each in (again.group.current, again.group.beside) if each] == [
        stand(each.run) for each in (playback.group.current, playback.group.beside) if each
    ]
    assert [lane.name for lane in again.snapshot().run_group.lanes] == [
        "branch 2: ε 0.3 from step 400, steps by hand",
        "branch 1",
    ]


def test_a_branch_in_which_the_world_was_drawn_says_so() -> None:
    stroke = EditWorld(read_edits("world.cell[0,1]=#"))
    drawn = (JournalEntry(7, stroke), JournalEntry(9, UndoEdit()), JournalEntry(9, TakeAction(1)))
    assert branch_in_words("branch 2", drawn, [()], "step") == "branch 2: world drawn, steps by hand"


def test_only_another_branch_can_and_there_must_be_room() -> None:
    playback = forked()
    for number in (1, 2, -1):
        shown = do(playback, AddBranch(number))
        assert shown.playback.paused_by
        assert shown.run_group.lanes == ()
    for alpha in (0.2, 0.3, 0.4):
        do(playback, AddLane((SetParameter("alpha", alpha),)))
    shown = do(playback, AddBranch(0))
    assert shown.playback.paused_by
    assert len(shown.run_group.lanes) == 4


# Names of runs

MADE = recipe("frozenlake-slippery", epsilon=0.1, alpha=0.1)
SARSA = recipe("frozenlake-slippery", algorithm="sarsa", epsilon=0.1, alpha=0.1)


def lane(branch: str, *journal: JournalEntry, begun: Recipe = MADE) -> LanePast:
    return LanePast(begun, begun, branch, journal)


AT_400 = JournalEntry(400, EXPLORE)
AT_600 = JournalEntry(600, SwitchAlgorithm("sarsa"))


def test_branches_are_named_by_what_was_done_there_only() -> None:
    assert lane_names([lane("branch 1"), lane("branch 2", AT_400)], "step") == [
        "branch 1",
        "branch 2: ε 0.3 from step 400",
    ]
    half = JournalEntry(600, SetParameter("alpha", 0.5))
    assert lane_names([lane("branch 2", AT_400, half), lane("branch 3", AT_400, AT_600)], "pull") == [
        "branch 2: α 0.5 from pull 600",
        "branch 3: SARSA from pull 600",
    ]


def test_of_many_changes_the_first_are_named_and_a_slider_that_was_dragged_is_one() -> None:
    drag = [JournalEntry(5_000, SetParameter("gamma", value / 100)) for value in range(98, 89, -1)]
    hands = [JournalEntry(step, TakeAction(1)) for step in range(6_000, 6_009)]
    long = lane("branch 2", AT_400, *drag, *hands)
    assert lane_names([lane("branch 1"), long], "step")[1] == (
        "branch 2: ε 0.3 from step 400, γ 0.9 from step 5,000, 1 more"
    )


def test_beside_other_runs_branches_say_of_which_they_are() -> None:
    lanes = [lane("branch 1"), lane("branch 1", begun=SARSA), lane("branch 2", AT_400)]
    assert lane_names(lanes, "step") == [
        "Q-learning, branch 1",
        "SARSA",
        "Q-learning, branch 2: ε 0.3 from step 400",
    ]


def test_runs_that_merely_began_alike_are_named_by_their_settings() -> None:
    changed = LanePast(MADE, recipe("frozenlake-slippery", epsilon=0.3, alpha=0.1), "branch 1", (AT_400,))
    assert lane_names([changed, lane("branch 1")], "step") == ["ε 0.3", "ε 0.1"]
    assert lane_names([lane("branch 1"), lane("branch 1")], "step") == ["Q-learning", "Q-learning (2)"]
