"""Drawing the world during learning."""

from __future__ import annotations

from pathlib import Path

import pytest
from conftest import MakeApp
from seams import app_at, click, on_screen, order, playground, press, screen_text, snapshot
from textual.pilot import Pilot
from textual.widgets import Input

from rl_tui.common.errors import UserError
from rl_tui.live.commands import AddBranch, DrawWorld
from rl_tui.runs.changes import read_world, written_world
from rl_tui.runs.library import recipe_for
from rl_tui.screen.app.opening import DrawingStart
from rl_tui.screen.app.screenshot import settle
from rl_tui.screen.dialogs.form import Choice, Prompt
from rl_tui.screen.panels.grid.grid import GridView
from rl_tui.screen.panels.last_step.last_step import OF_ANOTHER_WORLD, nothing_yet
from rl_tui.screen.playground.modes.editing import title
from rl_tui.worlds.editing.edit import as_json, read_edits
from rl_tui.worlds.editing.grid_draft import GridDraft
from rl_tui.worlds.files.catalogue import find
from rl_tui.worlds.mdp.digest import table_digest

pytestmark = pytest.mark.screen

REFUSED = (
    *("Pass pays nan", "Pass pays inf", "Pass pays 1e300", "Pass nan, Class 1", "x" * 61 + " pays 1"),
    *('{"to":"Pass","reward":NaN}', '{"to":{"Pass":1' + "0" * 400 + "}}", '{"to":' + "[" * 990),
    *('{"to":"Pass\\u001b[31m","reward":1}', '{"to":"Pass","reward":1,"state":"Pass"}'),
    '{"to":"Pass"} x',
)
"""Outcomes that no action can have."""


def lines(pilot: Pilot[UserError]) -> tuple[str, ...]:
    draft = snapshot(pilot).editor.draft
    assert isinstance(draft, GridDraft)
    return draft.lines


def digest(pilot: Pilot[UserError]) -> str:
    mdp = snapshot(pilot).world.mdp
    assert mdp is not None
    return table_digest(mdp)


async def click_cell(pilot: Pilot[UserError], cell: int) -> None:
    view = playground(pilot).board.world
    assert isinstance(view, GridView)
    where = next(
        (x, y) for y in range(view.size.height) for x in range(view.size.width) if view.place_at(x, y) == cell
    )
    await click(pilot, view, offset=(where[0] + view.gutter.left, where[1] + view.gutter.top))


async def test_a_lake_is_drawn_by_keys_alone_and_by_the_mouse_alone(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake"), (120, 40)) as pilot:
        before = digest(pilot)
        await press(pilot, "w", "d", "down", "right", "full_stop", "number_sign", "enter", "z", "z")
        assert digest(pilot) == before, "undone: what is painted twice is one stroke"
        await press(pilot, "full_stop", "H")
        assert digest(pilot) == before, "the hole is where it was"
        await press(pilot, "w", "i", "w", "d")
        assert digest(pilot) == before
        await press(pilot, "escape")
        assert snapshot(pilot).editor.draft is None
        strokes = len(snapshot(pilot).timeline.current.journal)
        await press(pilot, "w", "d")
        await click_cell(pilot, 2)
        assert lines(pilot)[0] == "S.#."
        assert len(snapshot(pilot).timeline.current.journal) == strokes + 1, "one stroke, one entry"


async def test_a_rectangle_is_copied_and_filled_and_rewards_are_typed_and_counted_up(
    make_app: MakeApp,
) -> None:
    async with on_screen(make_app("frozenlake"), (120, 40)) as pilot:
        await press(pilot, "w", "d", "down", "w", "m", "right", "w", "c", "down", "down", "w", "v")
        assert lines(pilot)[3] == "H.HG"
        await press(pilot, "w", "m", "right", "right", "number_sign")
        assert lines(pilot)[3] == "H###"
        await press(pilot, "up", "equals_sign", "5", "enter")
        for pays in (5.0, 4.0):
            draft = snapshot(pilot).editor.draft
            assert isinstance(draft, GridDraft)
            assert draft.legend[draft.lines[2][3]].pays == pays
            await press(pilot, "left_square_bracket")


async def test_without_a_start_it_is_a_draft_and_the_last_step_of_another_world_is_not_told(
    make_app: MakeApp,
) -> None:
    async with on_screen(make_app("frozenlake"), (120, 40)) as pilot:
        before = digest(pilot)
        shown = await press(pilot, "w", "d", "full_stop")
        assert shown.editor.unfinished
        assert digest(pilot) == before
        shown = await press(pilot, "s")
        assert shown.counters.step == 1, "learning goes on"
        assert nothing_yet(shown) != OF_ANOTHER_WORLD
        shown = await press(pilot, "down", "S")
        assert not shown.editor.unfinished
        assert shown.world.space.state_names[int(shown.world.mdp.start_state[0])] == "4"  # type: ignore[union-attr]
        assert len(shown.timeline.current.journal) == 1
        assert nothing_yet(shown) == OF_ANOTHER_WORLD


async def test_without_its_start_a_graph_says_what_is_missing_until_another_state_is_one(
    make_app: MakeApp,
) -> None:
    async with on_screen(make_app("student"), (120, 40)) as pilot:
        shown = await press(pilot, "w", "d", "w", "d")
        assert "Not yet: no start" in screen_text(pilot.app)
        assert title(shown)[0].startswith("Not a world yet: no start")
        shown = await press(pilot, "right", "S")
        assert "unreachable state" in screen_text(pilot.app), "nothing leads from Pass to the phone"


async def test_while_arms_are_drawn_the_legend_has_their_true_means_and_drift_is_no_mean_of_now(
    make_app: MakeApp,
) -> None:
    async with on_screen(make_app("bandit-drifting"), (120, 40)) as pilot:
        await press(pilot, "w", "d")
        drawing = screen_text(pilot.app)
        assert "true mean" in drawing
        assert "best arm" in drawing
        assert "pays 0 on average, at first: means drift" in drawing


@pytest.mark.parametrize("size", [(80, 24), pytest.param((120, 40), marks=pytest.mark.exhaustive("a size"))])
async def test_a_lane_of_another_world_stands_beside(make_app: MakeApp, size: tuple[int, int]) -> None:
    async with on_screen(make_app("frozenlake"), size) as pilot:
        await press(pilot, "s", "s", "s", "w", "d", "w", "i", "escape", "s", "b", "b", "a", "t")
        shown = await press(pilot, "s")
        assert len(shown.timeline.branches) == 2
        playground(pilot).lanes.link.send(AddBranch(0))
        await settle(pilot)
        shown = await press(pilot, "s", "c", "l", "s")
        assert shown.beside.world.space.states != shown.world.space.states
        board = playground(pilot).board
        first, second = (board.query_one(f"#{each}", GridView) for each in ("world", "world-beside"))
        assert not first.differing | second.differing, "maps of two sizes are not compared"
        assert {"not compared" in (first.footing + second.footing)} == {True}
        board.world.focus()  # type: ignore[union-attr]
        await press(pilot, "down", "right")
        led, other = (first, second) if board.world is first else (second, first)
        assert led.cursor is not None
        assert other.cursor is None
        await press(pilot, "s")
        assert led.cursor is not None, "the other lane does not take it away"


async def test_after_a_save_r_starts_again_in_the_world_that_was_drawn_and_asks_nothing(
    make_app: MakeApp, tmp_path: Path
) -> None:
    path = tmp_path / "mine.toml"
    path.write_text("[grid]\nmap = '''\nS...G\n'''\n", encoding="utf-8")
    async with on_screen(make_app(str(path))) as pilot:
        await press(pilot, "w", "d", "right", "H", "w", "s", "enter", "escape", "s")
        assert "SH..G" in path.read_text(encoding="utf-8")
        drawn = digest(pilot)
        await press(pilot, "r", "r")
        assert (digest(pilot), snapshot(pilot).counters.step) == (drawn, 0)
        assert not isinstance(pilot.app.screen, Choice)
        path.write_text("[grid]\nmap = '''\nS..G\n'''\n", encoding="utf-8")
        await press(pilot, "s", "r", "r")
        assert isinstance(pilot.app.screen, Choice)


@pytest.mark.exhaustive("plays each name by keys", but=["A, B 0.5"])
@pytest.mark.parametrize("name", ["A;B", "{x", "[x", "A, B 0.5"])
async def test_what_no_action_can_do_is_refused_but_a_strange_name_comes_through_a_session(
    make_app: MakeApp, name: str
) -> None:
    async with on_screen(make_app("student"), (120, 40)) as pilot:
        await press(pilot, "w", "d", "enter", "enter")
        for text in REFUSED:
            pilot.app.screen.query_one(Input).value = text
            shown = await press(pilot, "enter")
            assert isinstance(pilot.app.screen, Prompt), text
            assert str(pilot.app.screen.query_one(".error").render()).isprintable(), text
            assert not shown.timeline.current.journal, text
        await press(pilot, "escape", "enter", "enter")
        pilot.app.screen.query_one(Input).value = as_json({"reward": 0, "to": {name: 0.5, "Pass": 0.5}})
        await press(pilot, "enter")
        leave = read_edits(f'world.transition[{as_json(name)},leave]={{"to":"Class","reward":0}}')
        await order(pilot, DrawWorld(leave))
        await press(pilot, "w", "r", "down", "enter")
        pilot.app.screen.query_one(Input).value = name
        shown = await press(pilot, "enter")
        strokes = [each.change for each in shown.timeline.current.journal]
        assert len(strokes) == 3
        assert shown.world.space.state_names[int(shown.world.mdp.start_state[0])] == name
        assert [read_world(written_world(each)) for each in strokes] == strokes  # type: ignore[arg-type]


async def test_a_world_can_be_drawn_from_the_start_and_keys_that_draw_are_not_said_to_set_something() -> None:
    async with on_screen(app_at(DrawingStart(recipe_for(find("frozenlake"))))) as pilot:
        assert snapshot(pilot).editor.draft is not None
        drawing = screen_text(pilot.app)
        assert "a: change" not in drawing
        await press(pilot, "escape")
        assert "a: change" in screen_text(pilot.app)
