"""The panel of tools: what stands in it, its sliders, and that all of it is found by its name too."""

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
from rl_tui.screen.draw.to_ascii import to_ascii
from rl_tui.screen.frame.key_line import KeyLine
from rl_tui.screen.keys.registry import ACTIONS
from rl_tui.screen.panels.draw_panel import ToolList
from rl_tui.screen.playground.modes.editing import ALWAYS, TOOLBOXES
from rl_tui.screen.theme.glyphs import ASCII, UNICODE
from rl_tui.worlds.drawing import Arms, CellKind, Graph, Grid
from rl_tui.worlds.editing.arms_draft import ArmsDraft
from rl_tui.worlds.editing.graph_draft import GraphDraft, chances_of
from rl_tui.worlds.files.catalogue import find
from rl_tui.worlds.files.scenario import scenario_of

pytestmark = pytest.mark.screen

SIZES = [(80, 24), (120, 40)]
EDITING = next(action for action in ACTIONS if action.id == "editing.toggle")
DRAWINGS = {
    "map": Grid(2, 2, (CellKind.FLOOR,) * 4, (0, 1, 2, 3), ((0, -1), (1, 0), (0, 1), (-1, 0))),
    "graph": Graph(((0, 0), (1, 0))),
    "arms": Arms(10),
}


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
    """The keys of the actions that are found for ``query``, else their names, and their sentences."""
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
        assert not pilot.app.screen.query_one(ToolList).is_on_screen
        await press(pilot, "w", "d")
        glyphs, text = ASCII if ascii_only else UNICODE, screen_text(pilot.app)
        tools = (*TOOLBOXES[type(snapshot(pilot).world.drawing)]().tools, *ALWAYS)
        for tool in tools:
            written = "four moves" if tool.id == "moves" else f"{tool.shown} {tool.word}".strip()
            assert not tool.in_panel or to_ascii(written, glyphs) in text, written
        panel = playground(pilot).board.tools
        assert panel.sliders
        for each in panel.sliders:
            assert to_ascii(each.parameter.symbol, glyphs) in each.render_line(0).text
            assert panel.region.contains_region(each.region)
        assert not panel.show_vertical_scrollbar
        await press(pilot, "escape")
        assert not pilot.app.screen.query_one(ToolList).is_on_screen


async def test_tools_are_taken_by_a_click_by_their_names_and_by_quick_keys(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake"), (120, 40)) as pilot:
        tools, look = pilot.app.screen.query_one(ToolList), playground(pilot).look

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
        for tool in (*TOOLBOXES[Grid]().tools, *ALWAYS):
            assert tool.help in found(pilot, tool.label).values(), tool
        await pilot.app.screen.run_action("do(\"editing.use('H')\")")
        await settle(pilot)
        assert map_drawn(pilot).lines[0] == "SH.."
        await press(pilot, "right")
        await tap(pilot, "plus", "plus", "plus")
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
        await hands.begin()  # by the key line, once the world has focus
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
        assert notes(pilot.app)[-1] == "noise stays 0: 1.2 is not a number from 0 to 1"
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


async def test_noise_is_refused_on_slippery_ice_in_words(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake-slippery"), (120, 40)) as pilot:
        await press(pilot, "w", "d", "3", "right")
        assert not strokes(pilot)
        assert notes(pilot.app)[-1].startswith("noise stays 0: ")
        assert slider(pilot.app, "noise").value == 0.0


@pytest.mark.exhaustive("plays every world that cannot be drawn", but=["blackjack"])
@pytest.mark.parametrize(
    ("scenario", "reason"),
    [
        ("taxi", "no cells to walk about in"),
        ("blackjack", "nobody knows"),
        ("blackjack-table", "no cells"),
        ("cartpole", "nobody knows"),
    ],
    ids=["taxi", "blackjack", "blackjack-table", "cartpole"],
)
async def test_what_cannot_be_drawn_is_dim_with_the_reason(
    make_app: MakeApp, scenario: str, reason: str
) -> None:
    async with on_screen(make_app(scenario), (240, 40)) as pilot:
        sentence = found(pilot, EDITING.label)[EDITING.shown]
        assert sentence.startswith("Not here: ")
        assert reason in sentence
        assert EDITING.shown not in pilot.app.screen.query_one(KeyLine).render_line(0).text
        await press(pilot, "w", "d")
        assert f"Not now: {playground(pilot).editing.refused}." in screen_text(pilot.app)


async def test_a_rectangle_is_marked_copied_and_moved_by_the_mouse(make_app: MakeApp) -> None:
    async with on_screen(app_of_template("grid"), (120, 40)) as pilot:
        hands = Mouse(pilot)
        await hands.begin()
        view = playground(pilot).board.world
        await hands.tool("A arrow")
        await hands.drag(view, hands.offset((2, 2)), hands.offset((3, 3)))
        await settle(pilot)
        assert len(view.picked) == 4
        await hands.tool("y copy")
        await pilot.click(view, offset=hands.offset((0, 4)))
        await hands.tool("p paste")
        await settle(pilot)
        assert [line[4:6] for line in map_drawn(pilot).lines[:2]] == ["##", ".H"]
        await hands.tool("z undo")
        await settle(pilot)
        assert map_drawn(pilot).lines[0] == "S......"
        await hands.tool("Z redo")
        await settle(pilot)
        assert strokes(pilot) == 3
        await hands.tool("esc end")
        await settle(pilot)
        assert snapshot(pilot).editor.draft is None


async def test_of_a_graph_one_outcome_is_changed_by_the_mouse_and_a_state_goes_with_what_leads_there(
    make_app: MakeApp,
) -> None:
    async with on_screen(make_app("student"), (120, 40)) as pilot:
        await press(pilot, "w", "d", "up", "u")  # Phone
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
        await hands.tool("+ likelier")
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
        assert "nothing but Phone comes of check phone" in notes(pilot.app)[-1]
        await hands.tool("del action −")
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
        await hands.tool("R arm last")
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
        await press(pilot, "w")
        assert notes(pilot.app)[-1] == "saving is off here: this is a kiosk"
        assert len(pilot.app.screen_stack) == screens
        for key in ("i", "R", "I", "N"):
            await press(pilot, key)
            assert "at most 17 cells" in notes(pilot.app)[-1]
            assert map_drawn(pilot).rows == map_drawn(pilot).columns == 4
        # what is pasted over the edge is cut off there: nothing makes a map larger but its lines
        await press(pilot, "m", "down", "y", "down", "down", "right", "right", "p")
        assert map_drawn(pilot).rows == map_drawn(pilot).columns == 4


@pytest.mark.exhaustive("plays every drawing", but=["student"])
@pytest.mark.parametrize(
    ("scenario", "limit", "most", "keys"),
    [
        ("student", "graph_draft.MOST_STATES_WRITTEN", 4, ("i", "n", "e", "w", "enter")),
        ("bandit", "arms_draft.MOST_ARMS", 10, ("i",)),
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
