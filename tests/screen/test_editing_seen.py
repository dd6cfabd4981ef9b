"""The screen during drawing, with real keys."""

from __future__ import annotations

import gc
import weakref

import pytest
from conftest import MakeApp
from seams import on_screen, order, playground, press, screen_text, snapshot, train
from textual.pilot import Pilot

from rl_tui.common.errors import UserError
from rl_tui.live.commands import AddBranch, DrawWorld
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.library import recipe_named
from rl_tui.runs.recipe import begin
from rl_tui.screen.app.screenshot import settle
from rl_tui.screen.kit.counterparts import are_alike, in_common, pair_in, pairs_in, state_in
from rl_tui.screen.kit.row import beside
from rl_tui.screen.panels.arms import ArmsView
from rl_tui.screen.panels.graph.graph import GraphView
from rl_tui.screen.panels.grid.grid import GridView
from rl_tui.screen.panels.q_table.q_table import QTable
from rl_tui.screen.panels.side_by_side import greedy_differences
from rl_tui.screen.panels.world.view import WorldView
from rl_tui.worlds.editing.edit import read_edits

pytestmark = pytest.mark.screen
SIZES = [pytest.param((80, 24), marks=pytest.mark.exhaustive("a size")), (120, 40)]


def world(pilot: Pilot[UserError]) -> WorldView:
    view = playground(pilot).board.world
    assert view is not None
    return view


def drawn(pilot: Pilot[UserError]) -> str:
    view = world(pilot)
    return "\n".join(view.render_line(y).text for y in range(view.size.height))


@pytest.mark.parametrize("size", SIZES)
async def test_every_stroke_is_seen_before_it_is_in_force_and_the_cursor_keeps_its_cell(
    make_app: MakeApp, size: tuple[int, int]
) -> None:
    async with on_screen(make_app("frozenlake"), size) as pilot:
        shown = await press(pilot, "w", "d", "full_stop")
        assert "╱" in drawn(pilot)
        if size == (120, 40):  # otherwise there is no space for signs after the mode
            assert "╱ drawn" in screen_text(pilot.app), "the sign is explained"
        holes = drawn(pilot).count("●")
        shown = await press(pilot, "right", "H")
        assert drawn(pilot).count("●") == holes + 1
        assert shown.editor.draft is not shown.editor.base
        shown = await press(pilot, "down", "down", "S")
        assert shown.editor.draft is shown.editor.base
        assert "╱" not in drawn(pilot)
        world(pilot).put_cursor(6)
        await press(pilot, "w", "i")
        assert world(pilot).cursor == 6, "the new row"
        await press(pilot, "down", "w", "h")
        assert world(pilot).cursor == 2 * 5 + 2, "the new column"
        await press(pilot, "right", "z")
        assert world(pilot).cursor == 2 * 4 + 2, "the cell that is left of where it was"
        await press(pilot, "z")
        assert world(pilot).cursor == 6
        world(pilot).put_cursor(15)
        await press(pilot, "w", "d")
        assert world(pilot).cursor == 11, "its row is gone: the last one"


async def test_the_cursor_keeps_its_arm(make_app: MakeApp) -> None:
    async with on_screen(make_app("bandit"), (120, 40)) as pilot:
        await press(pilot, "w", "d")
        assert isinstance(world(pilot), ArmsView)
        world(pilot).put_cursor(3)
        await press(pilot, "w", "i")
        assert world(pilot).cursor == 3, "the new arm"
        await press(pilot, "down", "z")
        assert world(pilot).cursor == 3, "the arm that was there"


# Two worlds at once


async def two_lanes(pilot: Pilot[UserError], *strokes: str) -> Snapshot:
    await settle(pilot)
    await train(pilot, 200)  # each with 50 planning steps
    await press(pilot, "w", "d", *strokes, "escape", "b", "a", "t")
    await train(pilot, 200)
    playground(pilot).lanes.link.send(AddBranch(0))
    await settle(pilot)
    shown = snapshot(pilot)
    assert shown.beside is not None
    return shown


@pytest.mark.parametrize("size", SIZES)
async def test_maps_of_one_size_are_compared_by_cell_and_have_a_cursor_in_common(
    make_app: MakeApp, size: tuple[int, int]
) -> None:
    async with make_app("maze").run_test(size=size) as pilot:
        shown = await two_lanes(pilot, "home", "shift+right")
        board, other = playground(pilot).board, shown.beside
        assert not are_alike(shown.world, other.world)
        found = greedy_differences(shown, other)
        views = [board.query_one(f"#{each}", GridView) for each in ("world", beside("world"))]
        assert [view.differing for view in views] == [found.states, found.right]
        mine, theirs = (
            {view.world.drawing.cell_of_state[state] for state in view.differing}  # type: ignore[union-attr]
            for view in views
        )
        assert mine == theirs
        assert 0 < found.known <= min(shown.world.space.states, other.world.space.states)
        for lane, states in ((shown, found.states), (other, found.right)):
            for state in states:
                assert lane.agent.visits[list(lane.world.space.pairs_of(state))].any()
        assert "other" not in board.table.footing, "tables are compared of the same pairs alone"
        views[0].focus()
        await settle(pilot)
        views[0].put_cursor(30)
        await settle(pilot)
        assert [view.cursor for view in views] == [30, 30]
        for table, view in zip(("table", beside("table")), views, strict=True):
            state, panel = view.state_at(30), board.query_one(f"#{table}", QTable)
            assert state is not None
            assert panel.pointed == panel.snapshot.world.space.pairs_of(state)
        await press(pilot, "s", "s")
        assert [view.cursor for view in views] == [30, 30]


async def test_graphs_are_compared_by_name_and_the_cursor_keeps_its_state(make_app: MakeApp) -> None:
    async with on_screen(make_app("student"), (120, 40)) as pilot:
        await train(pilot, 500)
        shown = await press(pilot, "w", "d")
        world(pilot).put_cursor(shown.world.space.state_names.index("Pass"))
        # a new state in the text gets a number of its own before it
        edit = 'world.transition[Class,study]={"to":{"Bar":0.5,"Pass":0.5},"reward":-9}'
        await order(pilot, DrawWorld(read_edits(edit)))
        assert snapshot(pilot).world.space.state_names[world(pilot).cursor or 0] == "Pass"
        await press(pilot, "escape", "b", "a", "t")
        await train(pilot, 200)
        playground(pilot).lanes.link.send(AddBranch(0))
        await settle(pilot)
        shown = snapshot(pilot)
        other = shown.beside
        mine, theirs = shown.world.space, other.world.space
        one, two = mine.state_names, theirs.state_names
        assert list(one) != list(two)
        common = in_common(shown.world, other.world)
        for number, name in enumerate(one):
            there = state_in(number, shown.world, other.world)
            assert there is not None
            assert two[there] == name
            pairs = pairs_in(mine.pairs_of(number), shown.world, other.world)
            assert len(pairs) in (0, len(theirs.pairs_of(there)))
        assert state_in(two.index("Bar"), other.world, shown.world) is None
        found = greedy_differences(shown, other)
        assert {one[state] for state in found.states} == {two[state] for state in found.right}
        for pair in range(mine.pairs):
            assert pair_in(pair, shown.world, other.world) == common.pairs[pair]
        board = playground(pilot).board
        first, second = (board.query_one(f"#{each}", GraphView) for each in ("world", beside("world")))
        first.focus()
        await settle(pilot)
        first.put_cursor(one.index("Pass"))
        await settle(pilot)
        assert second.cursor == two.index("Pass")


def test_worlds_that_were_compared_are_not_kept_in_memory() -> None:
    one, other = (begin(recipe_named("frozenlake")).world for _ in range(2))
    assert are_alike(one, other)
    assert in_common(one, other).states.tolist() == list(range(16))
    gone = weakref.ref(one)
    del one
    gc.collect()
    assert gone() is None
