"""The panel of tools."""

from __future__ import annotations

from pathlib import Path

import pytest
from conftest import MakeApp
from drawing_hands import Mouse, app_of_template, map_drawn
from seams import app_at, notes, on_screen, playground, press, screen_text, slider, snapshot, tap
from textual.pilot import Pilot

from rl_tui.common import limits
from rl_tui.common.errors import UserError
from rl_tui.runs.library import recipe_for
from rl_tui.screen.app.app import RlTuiApp
from rl_tui.screen.app.find import entries_on, found_by
from rl_tui.screen.app.screenshot import settle
from rl_tui.screen.frame.key_line import KeyLine
from rl_tui.screen.keys.registry import ACTIONS
from rl_tui.screen.panels.draw_panel import SheetLine, ToolCell, ToolRows, ToolSheet, fitting
from rl_tui.screen.playground.modes.editing import ALWAYS, TOOLBOXES
from rl_tui.screen.theme.glyphs import ASCII, UNICODE
from rl_tui.worlds.drawing import CellKind, Graph, Grid
from rl_tui.worlds.editing.arms_draft import ArmsDraft
from rl_tui.worlds.editing.graph_draft import GraphDraft, chances_of
from rl_tui.worlds.files.catalogue import find
from rl_tui.worlds.files.scenario import scenario_of

pytestmark = pytest.mark.screen

SIZES = [(80, 24), (120, 40)]
EDITING = next(action for action in ACTIONS if action.id == "editing.toggle")


def graph_drawn(pilot: Pilot[UserError]) -> GraphDraft:
    draft = snapshot(pilot).editor.draft
    assert isinstance(draft, GraphDraft)
    return draft


def arms_drawn(pilot: Pilot[UserError]) -> ArmsDraft:
    draft = snapshot(pilot).editor.draft
    assert isinstance(draft, ArmsDraft)
    return draft


def strokes(pilot: Pilot[UserError]) -> int:
    return len(snapshot(pilot).timeline.current.journal)


def found(pilot: Pilot[UserError], query: str) -> dict[str, str]:
    entries = found_by(query, entries_on(pilot.app.screen))
    return {each.keys or each.name: each.sentence for each in entries if each.kind == "action"}


@pytest.mark.exhaustive(
    "plays every drawing at every size", but=["maze-80-text", "student-80-ascii", "bandit-80-text"]
)
@pytest.mark.parametrize("ascii_only", [False, True], ids=["text", "ascii"])
@pytest.mark.parametrize("size", SIZES, ids=["80", "120"])
@pytest.mark.parametrize("scenario", ["maze", "student", "bandit"])
async def test_every_tool_and_every_number_is_on_screen(
    make_app: MakeApp, scenario: str, size: tuple[int, int], ascii_only: bool
) -> None:
    async with on_screen(make_app(scenario, ascii=ascii_only), size) as pilot:
        assert not pilot.app.screen.query_one(ToolRows).is_on_screen
        await press(pilot, "w", "d")
        glyphs, text = ASCII if ascii_only else UNICODE, screen_text(pilot.app)
        tools = (*TOOLBOXES[type(snapshot(pilot).world.drawing)]().tools, *ALWAYS)
        for tool in tools:
            written = f"{tool.shown} {tool.label}"
            assert not tool.in_panel or tool.shown == "w" or glyphs.spelled(written) in text, written
        panel = playground(pilot).board.tools
        assert panel.sliders
        for each in panel.sliders:
            assert glyphs.spelled(each.parameter.symbol) in each.render_line(0).text
            assert panel.region.contains_region(each.region)
        await press(pilot, "w")
        text = screen_text(pilot.app)
        for tool in tools:
            written = f"{tool.key[-1]} {tool.label}"
            assert not tool.is_in_menu or glyphs.spelled(written) in text, written
        await press(pilot, "escape", "escape")
        assert not pilot.app.screen.query_one(ToolRows).is_on_screen


async def test_tools_are_taken_by_a_click_by_their_names_and_by_quick_keys(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake"), (120, 40)) as pilot:
        tools, look = pilot.app.screen.query_one(ToolRows), playground(pilot).look

        def standing_out() -> list[str]:
            pieces = [each for y in range(tools.size.height) for each in tools.render_line(y)]
            focus = look.palette.focus.bgcolor
            return [each.text.strip() for each in pieces if each.style and each.style.bgcolor == focus]

        assert "," not in found(pilot, "pick up")
        await press(pilot, "w", "d")
        assert standing_out() == ["# wall"]
        await Mouse(pilot).tool("H hole")
        await settle(pilot)
        assert standing_out() == ["H hole"]
        assert not strokes(pilot)
        assert playground(pilot).focused is playground(pilot).board.world, "keys draw as before"
        await press(pilot, "right")
        listed = {each.label: each.sentence for each in playground(pilot).actions}
        for tool in (*TOOLBOXES[Grid]().tools, *ALWAYS):
            assert listed[tool.label] in found(pilot, tool.label).values(), tool
        await pilot.app.screen.run_action("do(\"editing.use('H')\")")
        await settle(pilot)
        assert map_drawn(pilot).lines[0] == "SH.."
        await press(pilot, "right")
        await tap(pilot, *["right_square_bracket"] * 3)
        pays = map_drawn(pilot).legend[map_drawn(pilot).lines[0][2]].pays
        assert pays == 3.0, "keys count before their picture comes"


@pytest.mark.parametrize("size", [(80, 24), pytest.param((120, 40), marks=pytest.mark.exhaustive("a size"))])
async def test_drawing_is_found_by_words_and_a_fast_drag_is_one_stroke_without_gaps(
    make_app: MakeApp, size: tuple[int, int]
) -> None:
    async with on_screen(make_app("maze"), size) as pilot:
        for word in ("map", "wall", "paint", "draw", EDITING.label):
            assert EDITING.shown in found(pilot, word), word
        assert EDITING.shown not in pilot.app.screen.query_one(KeyLine).render_line(0).text
        hands = Mouse(pilot)
        await hands.begin()  # with the key line's key, while the world has focus
        view = playground(pilot).board.world
        assert view is not None
        await hands.drag(view, hands.offset((0, 0)), hands.offset((0, 6)))
        await settle(pilot)
        assert map_drawn(pilot).lines[0][:7] == "#######"
        assert strokes(pilot) == 1
        noise = slider(pilot.app, "noise")
        start = noise.render_line(0).text.index("●")
        await hands.drag(noise, (start, 0), (start + 6, 0))
        await settle(pilot)
        assert strokes(pilot) == 2
        assert map_drawn(pilot).rules["noise"] == noise.value > 0.0
        await press(pilot, "escape", "z")
        assert noise.value == 0.0, "the slider goes back with an undo"


async def test_numbers_are_typed_and_what_cannot_be_is_refused_in_words(make_app: MakeApp) -> None:
    async with on_screen(make_app("maze"), (120, 40)) as pilot:
        await press(pilot, "w", "d")
        await tap(pilot, "3", "enter", *"1.2", "enter")
        assert notes(pilot.app)[-1] == "noise stays 0: type a number from 0 to 1, not '1.2'"
        assert slider(pilot.app, "noise").has_focus
        await tap(pilot, "2", "-", *".04", "enter")
        assert map_drawn(pilot).rules["step_reward"] == -0.04
        assert playground(pilot).focused is playground(pilot).board.world
        assert strokes(pilot) == 1
        await press(pilot, "4", "right", "escape", "5", "right", "escape")
        assert map_drawn(pilot).rules["time_limit"] == 5
        column = (playground(pilot).board.world.cursor or 0) % map_drawn(pilot).columns  # type: ignore[union-attr]
        assert map_drawn(pilot).rules["wind"][column] == 1
        await press(pilot, "5", "left", "escape")
        assert "wind" not in map_drawn(pilot).rules


async def test_what_cannot_be_drawn_says_why(make_app: MakeApp) -> None:
    async with on_screen(make_app("blackjack"), (240, 40)) as pilot:
        sentence = found(pilot, EDITING.label)[EDITING.shown]
        assert sentence.startswith("Not here: ")
        assert EDITING.shown not in pilot.app.screen.query_one(KeyLine).render_line(0).text
        await press(pilot, "w", "d")
        assert f"Not here: {playground(pilot).editing.refused}." in screen_text(pilot.app)


async def test_a_rectangle_is_marked_copied_and_moved_by_the_mouse(make_app: MakeApp) -> None:
    async with on_screen(app_of_template("grid"), (120, 40)) as pilot:
        hands = Mouse(pilot)
        await hands.begin()
        view = playground(pilot).board.world
        await hands.tool("A arrow")
        await hands.drag(view, hands.offset((2, 2)), hands.offset((3, 3)))
        await settle(pilot)
        assert len(view.picked) == 4
        await hands.of_menu("copy")
        await pilot.click(view, offset=hands.offset((0, 4)))
        await hands.of_menu("paste")
        await settle(pilot)
        assert [line[4:6] for line in map_drawn(pilot).lines[:2]] == ["##", ".H"]
        await hands.tool("z undo")
        await settle(pilot)
        assert map_drawn(pilot).lines[0] == "S......"
        await hands.tool("Z redo")
        await settle(pilot)
        assert strokes(pilot) == 3
        await pilot.press("escape")
        await settle(pilot)
        assert snapshot(pilot).editor.draft is None


async def test_of_a_graph_one_outcome_is_changed_by_the_mouse_and_a_state_goes_with_what_leads_there(
    make_app: MakeApp,
) -> None:
    async with on_screen(make_app("student"), (120, 40)) as pilot:
        await press(pilot, "w", "d", "up", "w", "d")  # Phone
        assert graph_drawn(pilot).states == ("Class", "Pass", "Sleep")
        await press(pilot, "z")
        assert graph_drawn(pilot).states == ("Class", "Pass", "Phone", "Sleep")
        await press(pilot, "up", "down")
        hands = Mouse(pilot)

        def study() -> dict[str, float]:
            entry = graph_drawn(pilot).entry("Class", "study")
            assert entry is not None
            return chances_of(entry)

        await hands.tool("study → Class")
        await hands.tool("] more")
        await settle(pilot)
        assert study() == {"Pass": 0.75, "Class": 0.25}
        await hands.wheel(slider(pilot.app, "chance"), (1, 0), 5)
        await settle(pilot)
        assert study() == {"Pass": 0.7, "Class": 0.3}
        await hands.tool("check phone → Phone")
        await settle(pilot)
        await hands.wheel(slider(pilot.app, "pays"), (1, 0), 5)
        await settle(pilot)
        assert (graph_drawn(pilot).entry("Class", "check phone") or {})["reward"] == 1.0
        await hands.wheel(slider(pilot.app, "chance"), (1, 0), -1)
        await settle(pilot)
        assert "check phone always leads to Phone" in notes(pilot.app)[-1]
        await hands.tool("del remove")
        await settle(pilot)
        assert graph_drawn(pilot).entry("Class", "check phone") is None


async def test_a_graph_without_places_gets_those_of_the_picture() -> None:
    text = find("student").text
    bare = text[: text.index("[mdp.place]")] + text[text.index("[[mdp.transition]]") :]
    app = app_at(recipe_for(scenario_of(bare, Path("bare.toml"))))
    async with on_screen(app, (120, 40)) as pilot:
        before = snapshot(pilot).world.drawing
        assert isinstance(before, Graph)
        await press(pilot, "w", "d", "comma", "V")
        after = snapshot(pilot).world.drawing
        assert isinstance(after, Graph)
        moved = [each for each in range(len(before.places)) if before.places[each] != after.places[each]]
        assert moved
        assert set(graph_drawn(pilot).rules["place"]) == set(graph_drawn(pilot).states)


async def test_arms_are_drawn_by_the_mouse(make_app: MakeApp) -> None:
    async with on_screen(make_app("bandit"), (120, 40)) as pilot:
        await press(pilot, "w", "d")
        hands = Mouse(pilot)
        before = arms_drawn(pilot).means
        await hands.wheel(slider(pilot.app, "std"), (1, 0), 2)
        await hands.wheel(slider(pilot.app, "drift"), (1, 0), 1)
        await hands.of_menu("append arm")
        await settle(pilot)
        draft = arms_drawn(pilot)
        assert draft.rules["std"] == pytest.approx(1.1)
        assert draft.rules["drift"] == pytest.approx(0.01)
        assert draft.means == (*before, 0.0)
        mean = slider(pilot.app, "mean")
        start = mean.render_line(0).text.index("●")
        await hands.drag(mean, (start, 0), (mean.size.width - 1, 0))
        await settle(pilot)
        assert arms_drawn(pilot).means[0] == 3.0


def in_kiosk(scenario: str) -> RlTuiApp:
    return app_at(recipe_for(find(scenario)), kiosk=True)


async def test_in_a_kiosk_one_draws_and_saves_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("rl_tui.worlds.editing.grid_draft.MOST_CELLS", 17)
    async with on_screen(in_kiosk("frozenlake"), (120, 40)) as pilot:
        await press(pilot, "w", "d", "right", "H")
        assert map_drawn(pilot).lines[0] == "SH.."
        screens = len(pilot.app.screen_stack)
        await press(pilot, "w", "s")
        assert "Not here: saving is off here: this is a kiosk." in screen_text(pilot.app)
        await press(pilot, "escape")
        assert len(pilot.app.screen_stack) == screens
        for letter in "ibhe":
            await press(pilot, "w", letter)
            assert "at most 17 cells" in notes(pilot.app)[-1]
            assert map_drawn(pilot).rows == map_drawn(pilot).columns == 4
        # a paste over the edge is cut there: only lines make a map larger
        await press(pilot, "w", "m", "down", "w", "c")
        await press(pilot, "down", "down", "right", "right", "w", "v")
        assert map_drawn(pilot).rows == map_drawn(pilot).columns == 4


@pytest.mark.exhaustive("plays every drawing", but=["student"])
@pytest.mark.parametrize(
    ("scenario", "limit", "most", "keys"),
    [
        ("student", "graph_draft.MOST_STATES_WRITTEN", 4, ("w", "i", "n", "e", "w", "enter")),
        ("bandit", "arms_draft.MOST_ARMS", 10, ("w", "i")),
    ],
    ids=["student", "bandit"],
)
async def test_limits_of_size_hold_for_states_and_arms(
    monkeypatch: pytest.MonkeyPatch, scenario: str, limit: str, most: int, keys: tuple[str, ...]
) -> None:
    name = limit.rpartition(".")[2]
    assert getattr(limits, name) > most
    monkeypatch.setattr(f"rl_tui.worlds.editing.{limit}", most)
    async with on_screen(in_kiosk(scenario), (120, 40)) as pilot:
        await press(pilot, "w", "d", *keys)
        assert not strokes(pilot)
        assert f"{most}" in screen_text(pilot.app)


@pytest.mark.parametrize("kind", TOOLBOXES, ids=lambda kind: kind.__name__)
def test_tools_have_keys_of_their_own_and_take_no_small_letter_but_that_of_their_menu(kind: type) -> None:
    tools = (*TOOLBOXES[kind].tools, *ALWAYS)
    keys = [tool.key for tool in tools]
    assert len(set(keys)) == len(keys)
    assert {key for key in keys if len(key) == 1 and key.islower()} == {"w", "z"}
    assert {tool.key[0] for tool in tools if tool.is_in_menu} == {"w"}
    assert not {tool.key[-1] for tool in tools if tool.is_in_menu} & {*"jkq"}
    for tool in tools:
        assert len(tool.label.split()) <= 2, tool
        assert len(tool.help.split()) <= 10, tool


@pytest.mark.parametrize("scenario", ["maze", "student"])
async def test_the_least_terminal_has_all_brushes_the_number_and_the_way_to_the_rest(
    make_app: MakeApp, scenario: str
) -> None:
    async with on_screen(make_app(scenario), (60, 18)) as pilot:
        await press(pilot, "w", "d")
        text, panel = screen_text(pilot.app), playground(pilot).board.tools
        toolbox = TOOLBOXES[type(snapshot(pilot).world.drawing)]
        for tool in toolbox.tools:
            assert not (tool.in_panel or tool.is_of_number) or f"{tool.shown} {tool.label}" in text, tool
        assert f"w {toolbox.rest}" in text
        assert "sliders" in text
        assert panel.region.contains_region(panel.sliders[0].region)
        await press(pilot, "2")
        assert panel.sliders[1].parameter.symbol in panel.sliders[1].render_line(0).text
        assert panel.region.contains_region(panel.sliders[1].region), "it comes into view"


@pytest.mark.parametrize("on", [0, 4, 8])
def test_of_many_outcomes_the_chosen_one_is_shown_and_how_many_are_not(on: int) -> None:
    lines = tuple(SheetLine(f"outcome {number}", number, is_on=number == on) for number in range(9))
    tools = ToolCell("=", "=", "value"), ToolCell("w", "w", "rules")
    sheet = ToolSheet(about=(("here",),), lines=lines, of_number=tools[:1], rest=tools[1:])
    room = fitting(sheet, 30, 8, 3, UNICODE)
    assert room.tools + room.sliders + 2 == 8
    *seen, hint = room.sheet.lines
    assert [each.number for each in seen if each.is_on] == [on]
    assert f"{9 - len(seen)} more" in hint.text


async def test_a_slider_leaves_undo_to_the_drawing_and_digits_go_to_the_agent_where_the_panel_is_hidden(
    make_app: MakeApp,
) -> None:
    async with on_screen(make_app("frozenlake"), (80, 24)) as pilot:
        await press(pilot, "w", "d", "right", "enter")
        walls = snapshot(pilot).world.drawing.kinds.count(CellKind.WALL)
        shown = await press(pilot, "2", "z")
        assert walls == 1
        assert shown.world.drawing.kinds.count(CellKind.WALL) == 0
        await press(pilot, "escape")
        for hiding in (("d",), ("t", "m"), ("f",)):
            await press(pilot, *hiding, "1")
            assert playground(pilot).editing.is_on, hiding
            assert playground(pilot).focused is slider(pilot.app, "alpha"), hiding
            await press(pilot, "escape", *hiding)
