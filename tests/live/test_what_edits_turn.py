"""The draft, changed actions, and endless states."""

from __future__ import annotations

from edited_worlds import edit, small_graph, small_map
from playing import begin, do

from rl_tui.agents.exact.solve import solve
from rl_tui.live.commands import Apply, DrawWorld, HideAnswer, OpenEditor, RedoStroke, UndoStroke
from rl_tui.live.playback import Playback
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.answers.turned import TurnedStates
from rl_tui.runs.recipe import Recipe, SetParameter
from rl_tui.runs.run import Run
from rl_tui.worlds.drawing import Grid
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP


def drawing(made_from: Recipe) -> Playback:
    playback = begin(made_from)
    do(playback, OpenEditor(is_open=True))
    return playback


def stroke(playback: Playback, text: str) -> Snapshot:
    return do(playback, DrawWorld(edit(text).edits))


def best_by_name(mdp: TabularMDP, gamma: float) -> dict[str, set[str]]:
    solution = solve(mdp, gamma)
    return {
        name: {
            mdp.action_names[mdp.pair_action[pair]] for pair in mdp.pairs_of(state) if solution.greedy[pair]
        }
        for state, name in enumerate(mdp.state_names)
    }


def table(snapshot: Snapshot) -> TabularMDP:
    assert snapshot.world.mdp is not None
    return snapshot.world.mdp


def test_a_stroke_turns_the_states_whose_best_actions_are_others() -> None:
    playback = drawing(small_graph())
    before = best_by_name(table(playback.snapshot()), 0.9)
    # a new state, so that numbers and names differ
    shown = stroke(playback, 'transition[Class,study]={"to":{"Bar":1.0},"reward":-50}')
    assert not shown.editor.unfinished or shown.editor.draft is not shown.editor.base
    shown = stroke(playback, 'transition[Bar,go home]={"to":"Pass","reward":0}')
    after = best_by_name(table(shown), 0.9)
    names = shown.world.space.state_names
    expected = {name for name in names if name in before and before[name] != after[name]}
    assert {names[state] for state in shown.editor.turned} == expected
    assert "Bar" not in expected
    assert "Class" in expected


def test_undoing_a_stroke_turns_the_same_cells_back() -> None:
    playback = drawing(small_map())
    assert not playback.snapshot().editor.turned
    shown = stroke(playback, "cell[0,2]=#")
    turned = cells(shown)
    assert turned
    before, after = best_by_cell(begin(small_map()).snapshot()), best_by_cell(shown)
    assert turned == {cell for cell in before.keys() & after.keys() if before[cell] != after[cell]}
    assert cells(do(playback, UndoStroke())) == turned
    assert cells(do(playback, RedoStroke())) == turned
    assert not cells(stroke(playback, "reward[0,0]=0")), "until the next stroke"


def cells(snapshot: Snapshot) -> set[int]:
    assert isinstance(snapshot.world.drawing, Grid)
    return {snapshot.world.drawing.cell_of_state[state] for state in snapshot.editor.turned}


def best_by_cell(snapshot: Snapshot) -> dict[int, set[str]]:
    mdp, drawing = table(snapshot), snapshot.world.drawing
    assert isinstance(drawing, Grid)
    best = best_by_name(mdp, 0.9)
    return {
        drawing.cell_of_state[state]: best[name]
        for state, name in enumerate(mdp.state_names)
        if mdp.pairs_of(state)
    }


def test_nothing_is_turned_while_the_answer_is_hidden_or_for_another_discount() -> None:
    playback = drawing(small_map())
    assert stroke(playback, "cell[0,2]=#").editor.turned
    assert not do(playback, HideAnswer(is_hidden=True)).editor.turned
    assert do(playback, HideAnswer(is_hidden=False)).editor.turned
    assert not do(playback, Apply(SetParameter("gamma", 0.5))).editor.turned


def test_an_answer_that_comes_late_tells_then_what_was_turned() -> None:
    run, turned = Run(small_map()), TurnedStates()
    before = best_by_place(run)
    assert not turned.of(run, solve(table_of(run), 0.9))
    run.apply(edit("rows=+1@0"))
    assert not turned.of(run, None), "its answer is on the way"
    run.apply(edit("cell[1,2]=#"))
    assert not turned.of(run, None)
    found = turned.of(run, solve(table_of(run), 0.9))
    after = best_by_place(run)
    moved = {(row + 1, column): best for (row, column), best in before.items()}
    expected = {place for place in moved.keys() & after.keys() if moved[place] != after[place]}
    assert {place_of(run, state) for state in found} == expected != set()


def table_of(run: Run) -> TabularMDP:
    assert run.world.mdp is not None
    return run.world.mdp


def place_of(run: Run, state: int) -> tuple[int, int]:
    drawing = run.world.drawing
    assert isinstance(drawing, Grid)
    return divmod(int(drawing.cell_of_state[state]), drawing.columns)


def best_by_place(run: Run) -> dict[tuple[int, int], set[str]]:
    mdp = table_of(run)
    best = best_by_name(mdp, 0.9)
    return {place_of(run, s): best[name] for s, name in enumerate(mdp.state_names) if mdp.pairs_of(s)}


def test_another_run_has_no_part_in_it() -> None:
    turned = TurnedStates()
    one, other = Run(small_map()), Run(small_map())
    other.apply(edit("cell[0,2]=#"))
    other.apply(edit("cell[0,1]=#"))
    turned.of(one, solve(table_of(one), 0.9))
    assert not turned.of(other, solve(table_of(other), 0.9))


def test_the_draft_is_told_apart_from_the_world_in_force() -> None:
    playback = drawing(small_map())
    shown = stroke(playback, "cell[0,1]=H")
    assert shown.editor.draft is shown.editor.base
    shown = stroke(playback, "cell[0:3,0]=.")
    assert shown.editor.unfinished
    assert shown.editor.draft is not shown.editor.base
    assert shown.editor.base.lines[0] == "SH.G"  # type: ignore[union-attr]
    assert shown.editor.draft.lines[0] == ".H.G"  # type: ignore[union-attr]


def test_a_room_without_a_way_out_is_told_of_with_a_time_limit_too() -> None:
    playback = drawing(small_map())
    assert not playback.snapshot().editor.endless
    shown = stroke(playback, "cell[0,1]=#;cell[1,0]=#")
    drawing_ = shown.world.drawing
    assert isinstance(drawing_, Grid)
    assert {drawing_.cell_of_state[state] for state in shown.editor.endless} == {0}
    shown = stroke(playback, "cell[0,3]=.;cell[1,3]=.")
    assert not shown.editor.endless, "the time limit is what ends every episode here"
