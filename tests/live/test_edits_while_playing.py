"""Every branch of a run with edits equals its journal."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest
from edited_worlds import (
    ARM_STROKES,
    GRAPH_STROKES,
    LAKE_STROKES,
    MAP_STROKES,
    small_bandit,
    small_graph,
    small_lake,
    small_map,
)
from hypothesis import given, settings
from hypothesis import strategies as st
from playing import begin, do
from test_world_edits_to_the_bit import assert_valid, differing

from rl_tui.agents.catalogue import BY_ID
from rl_tui.live.commands import (
    AddBranch,
    AddLane,
    Apply,
    ChooseBranch,
    ChooseLane,
    Command,
    DrawAction,
    DrawWorld,
    DropLane,
    EpisodeBack,
    FollowCell,
    GoTo,
    OpenEditor,
    RedoStroke,
    Restart,
    Step,
    StepBack,
    StudyPolicy,
    Take,
    ToggleBreakpoint,
    Train,
    UndoStroke,
)
from rl_tui.live.playback import Playback
from rl_tui.live.record import Record
from rl_tui.live.sessions.session import encoded, read_session
from rl_tui.runs.answers.policy_kind import PolicyKind
from rl_tui.runs.recipe import EditWorld, Recipe, SetParameter, SwitchAlgorithm
from rl_tui.runs.run import Run

pytestmark = [pytest.mark.unit, pytest.mark.interpreted]
SMALL = st.integers(0, 30)


def deeds(strokes: st.SearchStrategy[EditWorld], algorithms: list[str]) -> st.SearchStrategy[list[Any]]:
    """Commands, "save" to save and reopen the session, "again" to restart the run."""
    draw = st.builds(lambda stroke: DrawWorld(stroke.edits), strokes)
    settings = st.one_of(
        st.builds(SetParameter, st.just("alpha"), st.sampled_from([0.1, 0.9])),
        st.builds(SwitchAlgorithm, st.sampled_from(algorithms)),
    )
    moves: list[st.SearchStrategy[Any]] = [
        st.builds(Train, st.integers(1, 60)),
        st.just(Step()),
        st.just(StepBack()),
        st.just(EpisodeBack()),
        st.builds(GoTo, step=SMALL),
        st.builds(Take, st.integers(0, 3)),
    ]
    others: list[st.SearchStrategy[Any]] = [
        st.builds(Apply, settings),
        st.builds(lambda each: AddLane((each,)), settings),
        st.builds(ChooseBranch, st.integers(0, 3)),
        st.builds(AddBranch, st.integers(0, 3)),
        st.builds(ChooseLane, st.integers(0, 3)),
        st.builds(DropLane, st.integers(1, 3)),
        st.builds(ToggleBreakpoint, state=SMALL),
        st.builds(ToggleBreakpoint, pair=SMALL),
        st.builds(DrawAction, SMALL, st.integers(0, 3)),
        st.builds(FollowCell, SMALL),
        st.just("save"),
        st.just("again"),
    ]
    edits: list[st.SearchStrategy[Any]] = [draw, draw, st.sampled_from([UndoStroke(), RedoStroke()])]
    return st.lists(st.one_of(st.one_of(moves), st.one_of(edits), st.one_of(others)), min_size=4, max_size=16)


def through_a_file(playback: Playback) -> Playback:
    with TemporaryDirectory() as folder:
        path = Path(folder) / "session.json"
        path.write_bytes(encoded(playback.record))
        record = read_session(path).record()
    return begin(record.lanes[record.shown].recipe, record)


def play(playback: Playback, what: list[Any]) -> Playback:
    do(playback, OpenEditor(is_open=True), StudyPolicy(PolicyKind.DRAWN))
    pinned = set[Any]()
    for deed in what:
        if deed == "save":
            playback = through_a_file(playback)
            do(playback, OpenEditor(is_open=True), StudyPolicy(PolicyKind.DRAWN))
        elif deed == "again":
            do(playback, Restart(playback.group.current.recipe))
        else:
            command: Command = deed
            do(playback, command)
        for run in playback.group.runs:
            assert run.world.mdp is not None
            assert_valid(run.world.mdp)
        playback.breakpoints.check(playback.group.current.run.world.space)
        names = names_of_breakpoints(playback)
        if isinstance(deed, ToggleBreakpoint):
            pinned |= names
        assert names <= pinned, "they stay with their cells and actions"
    return playback


def names_of_breakpoints(playback: Playback) -> set[Any]:
    run, breakpoints = playback.group.current.run, playback.breakpoints
    draft, space = run.edited.draft_in(run.recipe), run.world.space
    states, actions = draft.state_keys(run.world), draft.action_keys(run.world)
    pairs = [(states[space.state_of(pair)], actions[space.pair_action[pair]]) for pair in breakpoints.pairs]
    return {*(states[state] for state in breakpoints.states), *pairs}


def straight(playback: Playback) -> Run:
    record = playback.group.current.record
    run = Run(record.recipe, episode_limit=playback.group.current.run.world.budget)
    run.advance(steps=0)
    run.follow(record.branches[record.branch].journal, record.step)
    return run


def assert_all_as_written(playback: Playback) -> None:
    for lane in range(len(playback.group.runs)):
        do(playback, ChooseLane(lane))
        for branch in range(len(playback.group.current.timeline.branches)):
            do(playback, ChooseBranch(branch))
            current = playback.group.current
            assert not differing(current.run, straight(playback)), (lane, branch, current.run.journal)


def kept(record: Record) -> Any:
    """All of ``record`` except its scenario, which is another object."""
    lanes = [(lane.branches, lane.branch) for lane in record.lanes]
    return lanes, record.shown, record.breakpoints, record.drawn


def check(recipe: Recipe, what: list[Any]) -> None:
    playback = play(begin(recipe), what)
    saved, again = playback.record, through_a_file(playback)
    assert kept(again.record) == kept(saved)
    for one, other in zip(playback.group.runs, again.group.runs, strict=True):
        assert not differing(one, other)
    assert_all_as_written(playback)


@pytest.mark.parametrize("algorithm", BY_ID)
@settings(max_examples=12, deadline=None)
@given(what=deeds(MAP_STROKES, list(BY_ID)))
def test_on_a_map(algorithm: str, what: list[Any]) -> None:
    check(small_map(algorithm=algorithm), what)


@settings(max_examples=70, deadline=None)
@given(what=deeds(GRAPH_STROKES, list(BY_ID)))
def test_on_a_graph(what: list[Any]) -> None:
    check(small_graph(), what)


@settings(max_examples=70, deadline=None)
@given(what=deeds(LAKE_STROKES, list(BY_ID)))
def test_on_a_lake(what: list[Any]) -> None:
    check(small_lake(), what)


@settings(max_examples=70, deadline=None)
@given(
    policy=st.sampled_from(["epsilon-greedy", "ucb", "thompson", "gradient"]),
    what=deeds(ARM_STROKES, ["q-learning", "sarsa"]),
)
def test_on_a_bandit(policy: str, what: list[Any]) -> None:
    check(small_bandit(policy=policy), what)
