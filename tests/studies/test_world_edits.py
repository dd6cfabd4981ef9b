"""Edits of the world are part of the run."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from edited_worlds import edit, small_map
from playing import begin, do

from rl_tui.common.errors import UserError
from rl_tui.common.limits import LONGEST_EDIT
from rl_tui.live.commands import (
    AddLane,
    ChooseBranch,
    DrawWorld,
    GoTo,
    OpenEditor,
    Step,
    StepBack,
    Take,
    Train,
    UndoStroke,
)
from rl_tui.runs.changes import read_world, written_world
from rl_tui.runs.recipe import EditWorld, Recipe, SetParameter, TakeAction, UndoEdit
from rl_tui.runs.run import Run
from rl_tui.runs.timeline.branches import RunRecord
from rl_tui.runs.timeline.branching_run import BranchingRun
from rl_tui.runs.timeline.checkpoints import USUAL, Checkpoints
from rl_tui.studies.many_seeds.request import study_request
from rl_tui.studies.many_seeds.study import Study
from rl_tui.worlds.editing.edit import read_edits
from rl_tui.worlds.files.catalogue import find

pytestmark = pytest.mark.unit

EDITS = (
    "world.cell[0,3]=#",
    "world.cell[2,3]=H;world.cell[3,3]=.",
    "world.reward[1,0:3]=-0.5",
    "world.slippery=true",
    "world.rows=+1@1",
    "world.columns=-1@3",
    "world.time_limit=7",
    "world.cell[0,0]=.;world.cell[0,1]=S",
    "world.cell[0:4,0:4]=.",
)


def test_going_back_over_an_edit_brings_back_what_it_made_forget() -> None:
    lane = BranchingRun(RunRecord(Recipe(find("maze"))), Run(Recipe(find("maze"))).edited)
    lane.advance(8_000)
    known, step = lane.run.learner.q.copy(), lane.run.step
    assert known.any()
    lane.advance(1)
    lane.apply(EditWorld(read_edits("world.cell[0:6,1]=#;world.cell[5,1]=.")))
    lane.advance(50)
    lane.apply(UndoEdit())
    assert not np.array_equal(lane.run.learner.q, known), "undo does not bring back what was forgotten"
    lane.seek_to(step=step)
    while lane.seek is not None:
        lane.continue_seek(1_000)
    assert lane.run.world_changes == ()
    assert np.array_equal(lane.run.learner.q, known)


def test_knowledge_goes_with_its_cell() -> None:
    run = Run(Recipe(find("maze")))
    run.advance(400)
    space, q = run.world.space, run.learner.q.copy()
    known = {
        (name, int(space.pair_action[p])): q[p]
        for s, name in enumerate(space.state_names)
        for p in space.pairs_of(s)
    }
    run.apply(EditWorld(read_edits("world.rows=+1@2")))
    space = run.world.space
    for state, name in enumerate(space.state_names):
        row, column = divmod(int(name), 9)
        for pair in space.pairs_of(state):
            before = (
                None
                if row == 2
                else known.get((str((row - (row > 2)) * 9 + column), int(space.pair_action[pair])))
            )
            assert run.learner.q[pair] == (0.0 if before is None else before)


def test_an_episode_whose_cell_is_gone_is_given_up_and_counts_nowhere() -> None:
    run = Run(Recipe(find("maze")))
    run.advance(11)
    state, episodes = run.learner.state, run.learner.episodes
    row, column = divmod(int(run.world.space.state_names[state]), 9)
    run.apply(EditWorld(read_edits(f"world.cell[{row},{column}]=#")))
    assert run.world_changes[-1].given_up
    assert (run.learner.episode_step, run.learner.episodes) == (0, episodes)
    assert run.learner.last_step is None
    assert run.world.space.state_names[run.learner.state] == "18", "the next one begins at the start"


def test_a_planner_has_no_episode_to_give_up() -> None:
    run = Run(Recipe(find("maze"), algorithm="value-iteration"))
    run.advance(11)
    row, column = divmod(int(run.world.space.state_names[run.learner.state]), 9)
    run.apply(EditWorld(read_edits(f"world.cell[{row},{column}]=#")))
    assert not run.world_changes[-1].given_up
    assert run.learner.episode_step == 0, "another sweep begins"


def test_rewards_of_any_size_tell_nothing_of_arms_that_come_to_pay_0_or_1() -> None:
    recipe = replace(Recipe(find("bandit")), seed=4)
    run = Run(replace(recipe, hyperparameters=replace(recipe.hyperparameters, policy="thompson")))
    run.advance(50)
    assert run.learner.rule.rewards.sum() == 50
    run.apply(EditWorld(read_edits("world.std=0;world.arm[0:9]=0;world.arm[9]=1")))
    run.advance(50)
    assert run.learner.rule.rewards.sum() == 50
    assert run.learner.rule.total.max() > 30, "it has found the arm that pays 1"
    run.apply(EditWorld(read_edits("world.std=1")))
    assert run.learner.rule.rewards.sum() == 50, "counts of 0 and 1 are rewards like others"


def test_a_checkpoint_of_another_world_is_refused() -> None:
    run, other = Run(Recipe(find("maze"))), Run(Recipe(find("frozenlake")))
    with pytest.raises(ValueError, match="another world"):
        run.learner.restore(other.learner.checkpoint())


def test_of_two_worlds_of_one_size_a_checkpoint_of_one_is_refused_by_the_other() -> None:
    run, other = Run(Recipe(find("maze"))), Run(Recipe(find("maze")))
    other.apply(EditWorld(read_edits("world.reward[0,0]=-1")))
    assert run.world.space.pairs == other.world.space.pairs
    run.learner.restore(Run(Recipe(find("maze"))).learner.checkpoint())
    with pytest.raises(ValueError, match="another world"):
        run.learner.restore(other.learner.checkpoint())


def test_no_digest_is_worked_out_for_checkpoints_of_worlds_that_are_at_hand(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def refused(_: object) -> str:
        raise AssertionError("the digest of a large world takes long")

    monkeypatch.setattr("rl_tui.agents.world_change.table_digest", refused)
    playback = begin(small_map())
    for text in ("rows=+1@1", "cell[0,1]=#", "noise=0.4"):
        do(playback, Train(300), DrawWorld(edit(text).edits))
    do(playback, Train(300))
    assert len(playback.group.current.kept.checkpoints) > 2
    do(playback, *(GoTo(step) for step in (1_100, 700, 250, 650, 1_000, 100)), Step(), StepBack())
    do(playback, DrawWorld(edit("cell[0,2]=#").edits), Train(9), ChooseBranch(0), ChooseBranch(1))


def test_the_same_change_comes_to_the_same_world_again() -> None:
    playback = begin(small_map())
    do(playback, Train(300), DrawWorld(edit("rows=+1@1").edits), Train(300))
    world = playback.group.current.run.world
    do(playback, GoTo(100))
    first = playback.group.current.run.world
    assert first is not world
    do(playback, GoTo(400), AddLane((SetParameter("alpha", 0.9),)))
    assert {run.world for run in playback.group.runs} == {world}


def test_worlds_count_in_the_bound_of_checkpoints(monkeypatch: pytest.MonkeyPatch) -> None:
    run, kept = Run(Recipe(find("maze"))), Checkpoints()
    one = run.world.nbytes
    few = replace(USUAL, checkpoints=40 * one)
    monkeypatch.setattr("rl_tui.runs.timeline.checkpoints.limits", lambda: few)
    for number in range(60):
        run.apply(EditWorld(read_edits(f"world.reward[0,0]=-{number}.5")))
        run.advance(3)
        kept.add(run.checkpoint())
        run.advance(3)
        kept.add(run.checkpoint())  # in the same world
        assert kept.nbytes <= few.checkpoints
    assert 4 <= len(kept) < 80
    alone, same_world = Checkpoints(), Run(Recipe(find("maze")))
    for _ in range(60):
        same_world.advance(3)
        alone.add(same_world.checkpoint())
    assert len(alone) > len(kept), "a world that is shared counts once"


def test_arms_that_were_drawn_stay_and_pulls_are_told_by_the_means_of_their_time() -> None:
    recipe = replace(Recipe(find("bandit")), seed=4)
    run = Run(recipe)
    run.advance(200)
    before, means = run.bandit, run.world.mdp
    run.apply(EditWorld(read_edits("world.arm[2]=9;world.arms=-1@0")))
    assert before is not None
    assert np.array_equal(run.world.mdp.expected_reward[2:], means.expected_reward[3:])
    assert run.bandit == before
    run.advance(1)
    assert run.bandit.pulls == 201


def test_each_pull_is_told_by_the_means_of_its_moment_where_these_begin_to_drift_and_stop() -> None:
    run = Run(replace(Recipe(find("bandit")), seed=4))
    regret, best = 0.0, 0
    for drift in ("0.1", "0.2", "0", "0.3", "0"):
        for _ in range(40):
            mdp = run.learner.mdp
            means = mdp.expected_reward
            run.advance(1)
            last = run.learner.last_step
            regret += means.max() - means[last.pair]
            best += means[last.pair] == means.max()
        run.apply(EditWorld(read_edits(f"world.drift={drift}")))
        figures = run.bandit
        assert figures.regret == pytest.approx(regret)
        assert figures.best_arm_rate == best / figures.pulls


@pytest.mark.parametrize("text", [*EDITS, "world.undo=1", "world.redo=1"])
def test_a_change_of_the_world_is_written_as_it_is_read(text: str) -> None:
    assert read_world(written_world(read_world(text))) == read_world(text)


def test_a_stroke_that_no_session_could_keep_is_refused() -> None:
    run = Run(Recipe(find("maze")))
    stroke = EditWorld(read_edits("world.cell[0,0]=S") * (LONGEST_EDIT // 17))
    with pytest.raises(UserError, match="too large for a session file"):
        run.apply(stroke)
    assert run.journal == ()
    run.apply(EditWorld(stroke.edits[:1_000]))


def test_many_seeds_of_an_edited_run_are_the_runs_of_those_seeds() -> None:
    playback = begin(small_map())
    do(
        playback,
        Train(100),
        DrawWorld(edit("rows=+1@1").edits),
        Take(1),
        Train(50),
        DrawWorld(edit("noise=0.4").edits),
    )
    do(playback, Train(50))
    request = study_request(playback.group, is_awaited=True)
    assert "the world was changed during the run: each seed ends after 201 steps" in request.message
    assert "steps that you took yourself are left out" in request.message
    study = list(Study(request).reports())[-1]
    journal = tuple(e for e in playback.group.current.run.journal if not isinstance(e.change, TakeAction))
    alone = Run(small_map())
    alone.follow(journal, 201)
    assert study.lanes[0].this_seed["return_mean"] == alone.mean_return
    assert study.seeds == 8


def test_what_is_unfinished_is_drawn_once_and_not_for_every_picture() -> None:
    playback = begin(small_map())
    first = do(playback, OpenEditor(is_open=True), DrawWorld(edit("cell[0,0]=.;cell[2,0]=.").edits))
    again = do(playback, Step())
    assert first.editor.unfinished
    assert again.editor.draft is first.editor.draft
    other = do(playback, DrawWorld(edit("cell[1,0]=#").edits))
    assert other.editor.draft is not first.editor.draft


def test_strokes_that_wait_go_on_waiting_where_the_run_refuses_what_they_come_to(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def refusing(*_: object) -> None:
        raise UserError("not here")

    playback = begin(small_map())
    do(playback, OpenEditor(is_open=True), DrawWorld(edit("cell[0,0]=.;cell[2,0]=.").edits))
    with monkeypatch.context() as patch:
        patch.setattr("rl_tui.agents.learner_memory.check_compatible", refusing)
        shown = do(playback, DrawWorld(edit("cell[0,1]=S").edits))
    assert shown.playback.paused_by == "not here"
    assert shown.editor.unfinished
    shown = do(playback, DrawWorld(edit("cell[0,1]=S").edits))
    assert not shown.editor.unfinished
    assert len(shown.timeline.current.journal) == 1
    assert not do(playback, UndoStroke()).editor.unfinished
