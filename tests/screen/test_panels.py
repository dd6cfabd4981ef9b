"""The table of panels."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import pytest
from seams import app_at, notes, on_screen
from test_playground import playground, press
from textual.pilot import Pilot
from textual.strip import Strip
from textual.widget import Widget

from rl_tui.common.errors import UserError
from rl_tui.live.snapshot import Snapshot
from rl_tui.runs.library import recipe_for
from rl_tui.screen.app.app import RlTuiApp
from rl_tui.screen.app.find import entries_on
from rl_tui.screen.board import board, board_layout
from rl_tui.screen.draw.canvas import Piece, strips_of
from rl_tui.screen.frame import glossary
from rl_tui.screen.frame.key_line import KeyLine
from rl_tui.screen.frame.key_sheet import KeyPage, KeySheet
from rl_tui.screen.keys import registry
from rl_tui.screen.keys.action import Place
from rl_tui.screen.keys.bindings import bindings_of
from rl_tui.screen.keys.registry import ACTIONS, opening_actions
from rl_tui.screen.kit.panel import BoardPanel, Panel
from rl_tui.screen.kit.row import CURVE, MICROSCOPE, TABLE, WORLD, OpeningKey, PanelRow, beside
from rl_tui.screen.panels.catalogue import PANELS
from rl_tui.screen.playground import playground as playground_screen
from rl_tui.screen.playground.playground import Playground
from rl_tui.worlds.drawing import Arms
from rl_tui.worlds.files.catalogue import find


class StepCount(Panel):
    def picture(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        self.heading = "Steps"
        text = "" if snapshot is None else f"{snapshot.counters.step} so far"
        return strips_of([[Piece(text, self.look.palette.text)]], width, height, self.look)


STEPS = PanelRow(
    "step_count",
    "test_panels:StepCount",
    "Step count",
    "f9 counts the steps of the run.",
    opened_by=OpeningKey("f9", "count steps", "Count the steps.", rank=0),
)


AppWith = Callable[..., RlTuiApp]


@pytest.fixture
def app_with(monkeypatch: pytest.MonkeyPatch) -> AppWith:
    """Makes apps with one more row in the table."""

    def make(row: PanelRow, scenario: str = "student") -> RlTuiApp:
        for user in (board, board_layout, glossary, playground_screen):
            monkeypatch.setattr(user, "PANELS", (*PANELS, row))
        monkeypatch.setattr(registry, "ACTIONS", (*ACTIONS, *opening_actions([row])))
        more = {"BINDINGS": bindings_of(opening_actions([row])), "__module__": Playground.__module__}
        with_its_key = type("Playground", (Playground,), more)
        monkeypatch.setattr(playground_screen, "Playground", with_its_key)
        return app_at(recipe_for(find(scenario), {}, 0))

    return make


@pytest.mark.exhaustive("plays at another size", but=["size0"])
@pytest.mark.parametrize("size", [(80, 24), (120, 40)])
async def test_its_key_opens_and_closes_it_in_the_right_column(
    size: tuple[int, int], app_with: AppWith
) -> None:
    async with on_screen(app_with(STEPS), size) as pilot:
        screen, board = playground(pilot), playground(pilot).board
        board.table.focus()
        await press(pilot, "s", "f9")
        panel = board.panel("step_count")
        assert panel.region.x >= board.world.region.right
        assert panel.region.height > board.curve.region.height
        assert panel.has_focus
        assert not board.shows(TABLE)
        assert isinstance(panel, StepCount)
        assert panel.render_line(0).text.strip() == "1 so far"
        await press(pilot, "s")
        assert panel.render_line(0).text.strip() == "2 so far"
        assert panel.head == "Steps"
        await press(pilot, "f9")
        assert board.shows(TABLE)
        assert not board.shows("step_count")
        assert board.table.has_focus
        await press(pilot, "d", "f9")  # only one panel is open at a time
        assert board.opened == "step_count"
        assert not board.microscope.display
        await press(pilot, "d")
        assert board.opened == MICROSCOPE
        assert not panel.display
        await press(pilot, "f9", "f")
        assert board.region.contains_region(panel.region)
        assert not board.shows(CURVE)
        await press(pilot, "f")
        visited = set()
        for _ in range(13):
            await press(pilot, "tab")
            visited.add(board.panel_of(pilot.app.focused))
        assert {"step_count", CURVE} <= visited
        assert TABLE not in visited
        await press(pilot, "escape")  # leaves the cursor of a table or a world, or closes it
        screen.set_focus(None)
        if board.opened:
            await press(pilot, "escape")
        assert board.opened is None
        assert screen.is_attached


async def test_palette_help_and_key_line_list_it(app_with: AppWith) -> None:
    app = app_with(STEPS)
    async with on_screen(app, (120, 40)) as pilot:
        screen = playground(pilot)
        assert ("Count steps", "f9") in [(entry.name, entry.keys) for entry in entries_on(screen)]
        assert "f9 count steps" in screen.query_one(KeyLine).render_line(0).text
        await pilot.press("question_mark")
        await pilot.pause()
        assert isinstance(app.screen, KeySheet)
        await pilot.press("3")
        await pilot.pause()
        pages = app.screen.query(KeyPage)
        lines = [page.render_line(y).text for page in pages for y in range(page.size.height)]
        assert any(line.startswith("  Step count") for line in lines)


async def test_what_has_nothing_to_show_says_so(app_with: AppWith) -> None:
    row = replace(
        STEPS, lacks=lambda now: "" if isinstance(now.world.drawing, Arms) else "it has nothing to show"
    )
    async with on_screen(app_with(row), notifications=True) as pilot:
        await press(pilot, "f9")
        assert playground(pilot).board.opened is None
        assert "nothing to show" in notes(pilot.app)[-1]
    async with on_screen(app_with(row, "bandit")) as pilot:
        await press(pilot, "f9")
        assert playground(pilot).board.opened == "step_count"


def test_the_rows_have_ids_and_keys_of_their_own() -> None:
    assert len({row.id for row in PANELS}) == len(PANELS)
    keys = [key for action in ACTIONS if Place.PLAYGROUND & action.place for key in action.keys]
    assert len(set(keys)) == len(keys)


ALONE = (
    *("s", "s", "e", "s", "b", "v", "v", "v", "w", "h", "s", "w", "h", "1", "right"),
    *("right", "s", "escape", "e", "e", "t", "p", "s", "t", "p", "d", "s", "d", "w", "a", "s", "w", "n"),
    *("w", "m", "escape", "a", "a", "down", "enter", "s", "r", "r", "s", "t", "b", "e"),
)
BESIDE = ("s", "e", "b", "c", "l", "s", "c", "o", "s", "v", "r", "r", "s")


class Drawn(NamedTuple):
    rows: list[str]
    above: object
    below: object


def drawn(panel: BoardPanel) -> Drawn:
    widgets = panel, *panel.query(Widget)
    rows = [repr(list(each.render_line(y))) for each in widgets for y in range(each.size.height)]
    return Drawn(rows, panel.head, panel.foot)


async def check_kept(pilot: Pilot[UserError], *keys: str) -> None:
    board = playground(pilot).board
    for key in keys:
        await press(pilot, key)
        for panel in board.query(BoardPanel):
            kept = drawn(panel)
            if kept.rows and board.shows(str(panel.id)):
                panel.redraw()
                assert drawn(panel) == kept, (key, panel.id)


@pytest.mark.exhaustive("draws other worlds", but=["frozenlake-slippery"])
@pytest.mark.parametrize("scenario", ["frozenlake-slippery", "student", "bandit", "cliff"])
async def test_what_is_kept_from_frame_to_frame_is_what_would_be_drawn_afresh(
    scenario: str, app_with: AppWith
) -> None:
    async with on_screen(app_with(STEPS, scenario), (120, 40)) as pilot:
        await check_kept(pilot, *ALONE)
        await press(pilot, "escape", "c", "a", "down", "down", "enter")  # a refused key leaves its menu open
        assert playground(pilot).board.shows(beside(WORLD))
        await check_kept(pilot, *BESIDE)
