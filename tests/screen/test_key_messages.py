"""Messages of keys and clicks, the palette, borders, ctrl+c."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator

import pytest
from conftest import MakeApp
from seams import click, notes, on_screen, playground, press, screen_text, snapshot, tap, train
from textual.events import MouseDown
from textual.pilot import Pilot

from rl_tui.common.errors import UserError
from rl_tui.live.player import Player
from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.app.screenshot import settle
from rl_tui.screen.catalogue.catalogue import CatalogueScreen
from rl_tui.screen.dialogs.dialog import QuitQuestion
from rl_tui.screen.dialogs.form import Choice
from rl_tui.screen.frame.key_line import KeyLine
from rl_tui.screen.frame.message_line import MessageLine
from rl_tui.screen.kit.bindings import as_sentence
from rl_tui.screen.kit.layers import Layer
from rl_tui.screen.kit.panel import key_at
from rl_tui.screen.playground.playground import Playground

# Messages


@pytest.mark.parametrize(
    "size",
    [
        (80, 24),
        *(pytest.param(each, marks=pytest.mark.exhaustive("a size")) for each in [(60, 18), (120, 40)]),
    ],
)
async def test_a_message_covers_its_line_and_goes_with_the_next_key_and_leaving_is_asked_anew(
    size: tuple[int, int], make_app: MakeApp
) -> None:
    async with on_screen(make_app("student"), size, notifications=True) as pilot:
        await press(pilot, "s", "escape")
        assert len(notes(pilot.app)) == 1
        above_keys = size == (120, 40)  # with a free row
        assert pilot.app.screen.query_one(MessageLine).region.bottom_right == (size[0], size[1] - above_keys)
        await press(pilot, "v")
        assert notes(pilot.app) == []
        await press(pilot, "escape")
        assert isinstance(pilot.app.screen, Playground)
        assert len(notes(pilot.app)) == 1
        await pilot.press("escape")
        assert isinstance(pilot.app.screen, CatalogueScreen)
        assert notes(pilot.app) == []


async def test_a_message_goes_with_a_click_and_with_the_scenario_but_what_was_written_stays(
    make_app: MakeApp,
) -> None:
    async with on_screen(make_app("student"), notifications=True) as pilot:
        await press(pilot, "b")
        assert len(notes(pilot.app)) == 1
        pilot.app.post_message(MouseDown(None, 60, 5, 0, 0, 1, False, False, False))
        await pilot.pause()
        assert notes(pilot.app) == []
        await press(pilot, "s", "escape")
        assert len(notes(pilot.app)) == 1
        await press(pilot, "w", "right_square_bracket")
        assert notes(pilot.app) == []
        playground(pilot).notify("written: somewhere")
        await press(pilot, "s", "a", "a")
        assert notes(pilot.app) == ["written: somewhere"], "beyond the next key"
        assert pilot.app.screen.query_one(MessageLine).display
        assert not playground(pilot).query(MessageLine), "not behind a dialog"
        await press(pilot, "escape")
        assert playground(pilot).query_one(MessageLine).display


async def test_a_message_hides_no_panel_and_leaves_the_hint_at_the_right_end(make_app: MakeApp) -> None:
    async with on_screen(make_app("student")) as pilot:
        for size in ((60, 18), (80, 24), (80, 30)):
            await pilot.resize_terminal(*size)
            await press(pilot, "b")
            line = pilot.app.screen.query_one(MessageLine)
            keys = playground(pilot).query_one(KeyLine)
            lowest = max(panel.region.bottom for panel in playground(pilot).board.children if panel.display)
            rows = screen_text(pilot.app).splitlines()
            if size[1] < 30:
                assert line.region == keys.region or line.region.height > 1
                assert "This is step 0" in rows[line.region.y]
            else:
                assert line.region.bottom == keys.region.y
                assert line.region.y >= lowest, "in a row that no panel has"
                assert rows[keys.region.y].strip().startswith("space")


async def test_a_fault_has_up_to_three_rows_until_escape_which_does_nothing_else(make_app: MakeApp) -> None:
    async with on_screen(make_app("student"), (60, 18)) as pilot:
        playground(pilot).notify("a fault that goes on and on " * 20, severity="error")
        await press(pilot, "s", "v")
        line = pilot.app.screen.query_one(MessageLine)
        assert line.region.height == 3
        assert screen_text(pilot.app).splitlines()[-1].rstrip().endswith("esc: close")
        await press(pilot, "escape")
        assert not line.display
        assert notes(pilot.app) == []
        await press(pilot, "K")
        assert "no breakpoints" in notes(pilot.app)[-1], "escape did not begin to leave"
        await tap(pilot, "escape", "escape")
        assert isinstance(pilot.app.screen, CatalogueScreen)


def test_a_message_is_a_sentence_but_keys_symbols_and_paths_stay_as_they_are() -> None:
    said = {
        "nothing drawn yet": "Nothing drawn yet.",
        "α stays 0.1: too large": "α stays 0.1: too large.",
        "esc again: back to the catalogue": "esc again: back to the catalogue.",
        "written: /tmp/run.py": "Written: /tmp/run.py",
        "rl-tui grade runs it": "rl-tui grade runs it.",
        "What do you say?": "What do you say?",
    }
    assert {text: as_sentence(text) for text in said} == said


# Texts on a border


def test_a_key_is_found_where_its_hint_stands() -> None:
    hints = "arrows: pair   pgup pgdn: scroll   m: close"
    assert {key_at(hints, column) for column in range(hints.index("m: "))} == {None}
    assert {key_at(hints, column) for column in range(hints.index("m: "), len(hints))} == {"m"}
    hints = "esc: follow the agent · v  Q  Q*"
    assert key_at(hints, 3) == key_at(hints, 20) == "escape"


async def click_on(pilot: Pilot[UserError], text: str) -> None:
    table = playground(pilot).board.table
    spelled = text if table.look.glyphs.braille else text.replace("−", "-")
    await click(pilot, table, offset=(table.foot.index(spelled), table.outer_size.height - 1))


@pytest.mark.parametrize(
    "ascii_only", [False, pytest.param(True, marks=pytest.mark.exhaustive("other characters"))]
)
async def test_the_names_of_the_layers_answer_clicks(make_app: MakeApp, ascii_only: bool) -> None:
    async with on_screen(make_app("frozenlake", ascii=ascii_only), (120, 40)) as pilot:
        table = playground(pilot).board.table
        for name, layer in (("Q−Q*", Layer.ERROR), ("Q*", Layer.OPTIMAL), ("visits", Layer.VISITS)):
            await click_on(pilot, name)
            assert table.shown_layer is layer
        await click_on(pilot, "v ")
        assert table.shown_layer is Layer.Q


# ctrl+c


@pytest.mark.parametrize("key", ["ctrl+c", pytest.param("enter", marks=pytest.mark.exhaustive("a key"))])
async def test_the_keys_of_a_dialog_answer_clicks_on_its_border_and_those_after_ctrl_c_quit(
    make_app: MakeApp, key: str
) -> None:
    app = make_app("student")
    async with on_screen(app) as pilot:
        for hint, seed in (("esc", 0), ("enter", 7)):
            await press(pilot, "r", "s", "7")
            box = app.screen.query_one("#box")
            keys = str(box.border_subtitle)
            column = box.region.right - 3 - len(keys) + keys.index(hint)
            await click(pilot, offset=(column, box.region.bottom - 1))
            assert isinstance(app.screen, Playground)
            assert snapshot(pilot).recipe.seed == seed
        await train(pilot, 3)
        await pilot.press("ctrl+c")
        assert isinstance(app.screen, QuitQuestion)
        await press(pilot, "escape")
        assert isinstance(app.screen, Playground)
        assert snapshot(pilot).counters.step == 3
        await pilot.press("r", "i", "ctrl+c")
        assert isinstance(app.screen, QuitQuestion)
        await pilot.press(key)
        await pilot.pause()
        assert not app.is_running
    assert app.return_code == 0


async def test_ctrl_c_asks_after_a_drag_too(make_app: MakeApp) -> None:
    app = make_app("student")
    async with on_screen(app) as pilot:
        table = playground(pilot).board.table
        await pilot.mouse_down(table, offset=(3, 2))
        await pilot.hover(table, offset=(9, 4))
        await pilot.mouse_up(table, offset=(9, 4))
        await pilot.press("ctrl+c")
        assert isinstance(app.screen, QuitQuestion)


# Early keys, and places that do not exist


async def test_keys_typed_before_there_is_a_world_go_to_the_dialog_they_open(
    make_app: MakeApp, is_typed: asyncio.Event
) -> None:
    app = make_app("student")
    async with app.run_test(size=(80, 24)) as pilot:
        await pilot.press("s", "s", "m", "g", "1", "enter", "a", "a", "s")
        is_typed.set()
        await settle(pilot)
        await pilot.pause()
        assert isinstance(app.screen, Choice)
        await press(pilot, "escape")
        assert (snapshot(pilot).counters.step, snapshot(pilot).timeline.current.end) == (1, 2)


async def test_escape_is_never_held_back(make_app: MakeApp, monkeypatch: pytest.MonkeyPatch) -> None:
    async def never(player: Player) -> AsyncIterator[Snapshot]:
        await asyncio.Event().wait()
        yield await player.carried_out()

    monkeypatch.setattr(Player, "snapshots", never)
    app = make_app("student")
    async with app.run_test(size=(80, 24)) as pilot:
        await pilot.press("m", "e", "escape")
        assert isinstance(app.screen, CatalogueScreen)


async def test_in_the_least_terminal_names_of_numbers_are_written_close_together(make_app: MakeApp) -> None:
    async with on_screen(make_app("cartpole"), (60, 18)) as pilot:
        table = playground(pilot).board.table
        rows = [table.render_line(y).text for y in range(table.size.height)]
        assert any("−.03,−.17" in row for row in rows)
        assert not any("…" in row for row in rows)


async def test_a_message_is_spelled_in_the_characters_of_the_terminal(make_app: MakeApp) -> None:
    async with on_screen(make_app("student", ascii=True), notifications=True) as pilot:
        for number, say in enumerate((playground(pilot).tell, playground(pilot).notify)):
            say(f"converged, {number}; another γ goes on")
            await pilot.pause()
            assert notes(pilot.app)[-1] == f"converged, {number}; another gamma goes on"
