"""Pins stay through every change of the world."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from edited_worlds import edit, small_graph, small_map
from playing import begin, do
from recipes import recipe

from rl_tui.common.errors import UserError
from rl_tui.live.commands import (
    AddBranch,
    AddLane,
    ChooseBranch,
    ChooseLane,
    DrawAction,
    DrawWorld,
    FollowCell,
    GoTo,
    OpenEditor,
    Restart,
    RunUntil,
    Step,
    StepBack,
    StudyPolicy,
    ToggleBreakpoint,
    Train,
    UndoStroke,
)
from rl_tui.live.pace.until import Breakpoints, Event, Until
from rl_tui.live.playback import Playback
from rl_tui.live.sessions.session import encoded, read_session
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.answers.policy_kind import PolicyKind
from rl_tui.runs.answers.policy_values import DrawnPolicy
from rl_tui.runs.library import recipe_for
from rl_tui.runs.recipe import EditWorld, SetParameter
from rl_tui.worlds.drawing import Grid
from rl_tui.worlds.files.scenario import scenario_of

pytestmark = pytest.mark.unit
DOWN = 1


def draw(text: str) -> DrawWorld:
    return DrawWorld(edit(text).edits)


def state_at(shown: Snapshot, row: int, column: int) -> int:
    drawing = shown.world.drawing
    assert isinstance(drawing, Grid)
    return drawing.cell_of_state.index(row * drawing.columns + column)


def pair_at(shown: Snapshot, row: int, column: int, action: int = DOWN) -> int:
    pair = shown.world.space.pair_of(state_at(shown, row, column), action)
    assert pair is not None
    return pair


def pinned(playback: Playback, row: int, column: int) -> Snapshot:
    shown = playback.snapshot()
    state, pair = state_at(shown, row, column), pair_at(shown, row, column)
    return do(
        playback,
        ToggleBreakpoint(state=state),
        ToggleBreakpoint(pair=pair),
        DrawAction(state, DOWN),
        FollowCell(pair),
    )


def assert_pinned(shown: Snapshot, row: int, column: int) -> None:
    state, pair = state_at(shown, row, column), pair_at(shown, row, column)
    assert shown.playback.breakpoints == Breakpoints(frozenset({state}), frozenset({pair}))
    assert shown.answers.drawn == DrawnPolicy(((state, DOWN),))


def assert_nothing_pinned(shown: Snapshot) -> None:
    assert not shown.playback.breakpoints
    assert shown.answers.drawn == DrawnPolicy()
    assert shown.cell is None


def test_pins_go_with_their_cell_and_its_action() -> None:
    playback = begin(small_map())
    pinned(playback, 1, 2)
    shown = do(playback, Train(20), draw("rows=+1@1"))
    assert_pinned(shown, 2, 2)
    assert shown.cell.pair == pair_at(shown, 2, 2)
    shown = do(playback, Step(), draw("columns=-1@1"))
    assert_pinned(shown, 2, 1)


def test_what_is_pinned_to_a_cell_that_is_gone_comes_back_with_it() -> None:
    playback = begin(small_map())
    pinned(playback, 1, 2)
    do(playback, Train(20))
    assert_nothing_pinned(do(playback, draw("cell[1,2]=#")))
    shown = do(playback, Step(), UndoStroke())
    assert_pinned(shown, 1, 2)
    assert shown.cell is None, "that is where the cursor is"
    assert_nothing_pinned(do(playback, GoTo(20)))
    assert_pinned(do(playback, StepBack()), 1, 2)


def test_going_on_over_a_change_of_the_world_keeps_pins_with_their_cell() -> None:
    playback = begin(small_map())
    do(playback, Train(20), draw("rows=+1@1"), Train(20), GoTo(5))
    pinned(playback, 1, 2)
    assert_pinned(do(playback, Train(30)), 2, 2)
    assert playback.group.step == 35, "training stops at no breakpoint"


def test_a_run_stops_at_its_breakpoint_wherever_the_world_has_moved_it() -> None:
    playback = begin(small_map())
    do(playback, Train(20), draw("rows=+2@0"), Train(200), GoTo(5))
    shown = playback.snapshot()
    do(playback, ToggleBreakpoint(state=state_at(shown, 1, 2)))
    do(playback, GoTo(20))
    while playback.snapshot().counters.step < 150:
        shown = do(playback, RunUntil(Until(Event.STEP, 150)))
        if shown.playback.paused_by.startswith("breakpoint"):
            break
    assert shown.counters.last_step.next_state == state_at(shown, 3, 2)


def test_other_marks_that_are_set_meanwhile_count() -> None:
    playback = begin(small_map())
    pinned(playback, 1, 2)
    shown = do(playback, Train(20), draw("cell[1,2]=#"))
    do(playback, ToggleBreakpoint(state=state_at(shown, 0, 1)))
    shown = do(playback, UndoStroke())
    assert shown.playback.breakpoints == Breakpoints(frozenset({state_at(shown, 0, 1)}))


def test_lanes_and_branches_in_other_worlds_show_the_same_cells() -> None:
    playback = begin(small_map())
    pinned(playback, 1, 2)
    do(playback, Train(40), GoTo(20), draw("rows=+1@0"))
    assert_pinned(do(playback, Train(10)), 2, 2)
    assert_pinned(do(playback, ChooseBranch(0)), 1, 2)
    assert_pinned(do(playback, ChooseBranch(1)), 2, 2)
    assert_pinned(do(playback, AddBranch(0), ChooseLane(1)), 1, 2)
    assert_pinned(do(playback, ChooseLane(0)), 2, 2)


def test_a_session_keeps_pins_of_cells_that_were_added(tmp_path: Path) -> None:
    playback = begin(small_map())
    shown = do(playback, Train(20), draw("rows=+2@3"))
    last = shown.world.space.states - 1
    shown = do(playback, ToggleBreakpoint(state=last), DrawAction(last, 0), Train(5))
    path = tmp_path / "session.json"
    path.write_bytes(encoded(playback.record))
    record = read_session(path).record()
    again = begin(record.lanes[0].recipe, record)
    assert again.breakpoints == playback.breakpoints == Breakpoints(frozenset({last}))
    assert again.questions.drawn == playback.questions.drawn
    assert not do(again, GoTo(5)).playback.breakpoints, "that world has no such cell"


def test_a_breakpoint_on_what_no_world_of_the_session_has_is_refused(tmp_path: Path) -> None:
    playback = begin(small_map())
    do(playback, Train(20), draw("rows=+1@0"))
    record = replace(playback.record, breakpoints=Breakpoints(frozenset({99})))
    with pytest.raises(UserError, match="there is no state 99: choose"):
        begin(record.lanes[0].recipe, record)


@pytest.fixture
def steps_one_by_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("rl_tui.live.pace.transport.PIECE", 1)


@pytest.mark.usefixtures("steps_one_by_one")
def test_what_a_run_waits_for_goes_with_its_cell_too() -> None:
    playback = begin(small_map())
    do(playback, Train(40), GoTo(3), draw("rows=+1@0"), Train(40), GoTo(0))
    pair = pair_at(playback.snapshot(), 0, 1, action=2)
    shown = do(playback, RunUntil(Until(Event.VALUE, pair=pair, threshold=0.8)))
    moved = pair_at(shown, 1, 1, action=2)
    assert shown.playback.paused_by == f"Q({shown.world.space.pair_name(moved)}) reaches 0.8"
    assert shown.agent.q[moved] >= 0.8


@pytest.mark.usefixtures("steps_one_by_one")
def test_a_run_does_not_wait_for_what_is_gone() -> None:
    playback = begin(small_map())
    do(playback, Train(40), GoTo(3), draw("cell[1,2]=#"), Train(40), GoTo(0))
    pair = pair_at(playback.snapshot(), 1, 2)
    shown = do(playback, RunUntil(Until(Event.VALUE, pair=pair, threshold=-99.0)))
    assert shown.counters.step == 3
    assert shown.playback.paused_by == "the stop condition is no longer in the world"


def test_a_lane_beside_in_another_world_has_them_by_its_own_numbers() -> None:
    playback = begin(small_map())
    do(playback, Train(20), AddLane((SetParameter("alpha", 0.9),)), draw("rows=+1@1"))
    pinned(playback, 3, 0)
    shown = do(playback, StudyPolicy(PolicyKind.DRAWN))
    assert_pinned(shown, 3, 0)
    assert_pinned(shown.beside, 2, 0)
    assert state_at(shown, 3, 0) >= shown.beside.world.space.states, "there is no such number there"
    drawn = shown.beside.answers.policies[PolicyKind.DRAWN].policy
    assert drawn[pair_at(shown.beside, 2, 0)] == 1.0
    shown = do(playback, Step())
    assert shown.beside is not None
    assert_pinned(shown.beside, 2, 0)
    pinned(playback, 1, 0)
    assert do(playback, Step()).playback.breakpoints.states != shown.playback.breakpoints.states
    assert_pinned(do(playback, ChooseLane(1)), 2, 0)


def test_what_is_optimal_is_asked_of_the_world_in_force() -> None:
    playback = begin(small_graph(epsilon=0.5))
    do(playback, Train(3), draw('transition["Phone","wander"]={"to":"Pass","reward":1}'), GoTo(0))
    shown = do(playback, RunUntil(Until(Event.OPTIMAL)))
    solution, mdp = shown.exact_answer.solution, shown.world.mdp
    assert shown.counters.step > 3
    assert solution is not None
    assert mdp is not None
    for state in (0, 1, 2):
        own = shown.agent.q[mdp.pairs_of(state)[0] : mdp.pairs_of(state)[-1] + 1]
        assert solution.best[mdp.pairs_of(state)[0] + own.argmax()]


@pytest.mark.usefixtures("steps_one_by_one")
def test_a_policy_that_an_edit_makes_optimal_as_it_is_is_noticed() -> None:
    path = Path("arms.toml")
    scenario = scenario_of("[bandit]\nmeans = [0.5, 1.0]\nstd = 0.0\nbudget = 400\n", path)
    playback = begin(recipe_for(scenario, {"epsilon": 0.0, "ties": "first"}, 0))
    do(playback, Train(20), draw("arm[0]=3"), Train(100), GoTo(10))
    assert do(playback, RunUntil(Until(Event.OPTIMAL))).counters.step == 20, "it pulls arm 0 all the time"


def test_a_run_begins_again_in_the_world_as_it_was_drawn() -> None:
    playback = begin(small_map())
    pinned(playback, 1, 2)
    do(playback, Train(20), draw("rows=+1@0"), Train(20), draw("cell[0,0]=G"))
    drawn = playback.snapshot().world.drawing
    shown = do(playback, Restart(playback.group.current.recipe))
    assert (shown.counters.step, shown.world.drawing) == (0, drawn)
    assert [entry.step for entry in shown.timeline.current.journal] == [0, 0]
    assert_pinned(shown, 2, 2)
    shown = do(playback, UndoStroke(), UndoStroke())
    assert_pinned(shown, 1, 2)


def test_the_run_beside_has_pins_by_the_numbers_of_its_own_world() -> None:
    playback = begin(small_map(), automatic=False)
    do(playback, OpenEditor(is_open=True), Train(20), AddLane((SetParameter("alpha", 0.9),)))
    shown = do(playback, StudyPolicy(PolicyKind.DRAWN), draw("rows=+3@0"))
    added, moved = state_at(shown, 2, 3), state_at(shown, 5, 0)
    do(playback, DrawAction(added, DOWN), DrawAction(moved, DOWN))
    shown = do(playback, ToggleBreakpoint(added), ToggleBreakpoint(moved))
    assert shown.beside.world.space.states < moved
    there = state_at(shown.beside, 2, 0)
    assert shown.beside.answers.drawn.choices == ((there, DOWN),)
    assert not shown.beside.answers.left_to_chance[there]
    assert shown.beside.playback.breakpoints.states == {there}
    assert shown.answers.drawn.choices == ((added, DOWN), (moved, DOWN))
    assert shown.playback.breakpoints.states == {added, moved}
    assert shown.beside.answers.policies[PolicyKind.DRAWN].is_known


def test_another_map_from_the_seed_is_not_drawn_in() -> None:
    playback = begin(recipe("frozenlake-random", seed=1))
    do(playback, Train(20), draw("rows=+1@0"), ToggleBreakpoint(state=0))
    shown = do(playback, Restart(recipe("frozenlake-random", seed=2)))
    assert shown.timeline.current.journal == ()
    assert not shown.playback.breakpoints


def test_a_lane_begins_in_the_same_world_and_can_be_drawn_in_alone() -> None:
    playback = begin(small_map())
    do(playback, Train(20), draw("rows=+1@0"), Train(20))
    do(playback, AddLane((SetParameter("alpha", 0.9),)))
    one, other = playback.group.runs
    assert one.world is other.world
    do(playback, ChooseLane(1), draw("cell[0,0]=G"), Step())
    one, other = playback.group.runs
    assert one.world is not other.world
    assert [run.step for run in playback.group.runs] == [41, 41]


def test_strokes_that_wait_stay_while_the_world_does() -> None:
    playback = begin(small_map())
    do(playback, OpenEditor(is_open=True), Train(20), draw("rows=+1@0"), Train(20))
    waits = draw("cell[1,0]=.;cell[3,0]=.")
    assert do(playback, waits).editor.unfinished
    assert do(playback, StepBack(), Step(), GoTo(21)).editor.unfinished
    shown = do(playback, draw("cell[0,0]=S"))
    assert not shown.editor.unfinished
    made = shown.timeline.current.journal[-1].change
    assert isinstance(made, EditWorld)
    assert len(made.edits) == 3
    do(playback, draw("cell[0,0]=."))
    assert not do(playback, GoTo(10)).editor.unfinished, "that is another world"


def test_how_an_estimate_went_begins_with_the_world_it_is_of() -> None:
    playback = begin(small_map())
    do(playback, draw("rows=+2@3"), Train(5))
    last = playback.group.current.run.world.space.pairs - 1
    shown = do(playback, FollowCell(last))
    assert shown.cell.step.tolist() == [1, 2, 3, 4, 5]
