"""The sheet of all keys."""

from __future__ import annotations

import re

import pytest
from conftest import MakeApp
from seams import on_screen, playground, press, tap
from textual.containers import VerticalScroll
from textual.pilot import Pilot

from rl_tui.common.errors import UserError
from rl_tui.screen.app.find import FindScreen
from rl_tui.screen.frame.glossary import GlossaryScreen
from rl_tui.screen.frame.help import HelpScreen
from rl_tui.screen.frame.key_sheet import KeySheet
from rl_tui.screen.keys.action import MENUS
from rl_tui.screen.playground.playground import Playground


def shown(pilot: Pilot[UserError]) -> str:
    screen = pilot.app.screen
    assert isinstance(screen, KeySheet)
    page = screen.query_one("KeyPage")
    return "\n".join(page.render_line(y).text for y in range(page.size.height))


@pytest.mark.parametrize("size", [(120, 40), (80, 24)], ids=["120", "80"])
@pytest.mark.parametrize("focus", ["", "tab"])
async def test_all_keys_are_on_one_screen(make_app: MakeApp, size: tuple[int, int], focus: str) -> None:
    async with on_screen(make_app("frozenlake"), size) as pilot:
        await press(pilot, *focus.split(), "question_mark")
        text = shown(pilot)
        assert pilot.app.screen.query_one(VerticalScroll).max_scroll_y == 0
        assert ("World, in focus" in text) is bool(focus)
        everywhere = text.partition("Everywhere")[2]
        for action in playground(pilot).actions:
            if action.menu and action.refused and size[0] < 120:
                continue  # its menu says why not
            key = action.letter if action.menu and size[0] < 120 else action.shown
            entry = f"{key} {action.label}" if action.entry is None else " ".join(action.entry)
            if focus and action.unfocused:
                assert entry.strip() not in everywhere, action.id  # the panel takes its key
                continue
            is_heading = action.key in MENUS and re.search(rf"\b{action.key} +{MENUS[action.key]}", text)
            assert is_heading or action.everywhere or entry.strip() in text, action.id


async def test_the_entries_of_menus_are_in_columns(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake")) as pilot:
        await press(pilot, "question_mark")
        lines = shown(pilot).partition("a Agent")[2].splitlines()
        starts = {entry.start() for line in lines[1:] for entry in re.finditer(r"(?<=  )\S [A-Za-z]", line)}
        assert len(starts) <= 3


async def test_a_panel_without_a_title_is_only_called_in_focus(make_app: MakeApp) -> None:
    async with on_screen(make_app()) as pilot:
        await tap(pilot, "question_mark")
        assert shown(pilot).startswith("In focus")


async def test_in_the_least_terminal_it_scrolls(make_app: MakeApp) -> None:
    async with on_screen(make_app("frozenlake", ascii=True), (60, 18)) as pilot:
        await press(pilot, "question_mark")
        assert "r Again" in shown(pilot)
        assert pilot.app.screen.query_one(VerticalScroll).max_scroll_y > 0


async def test_question_marks_turn_to_words_and_pages_and_close(make_app: MakeApp) -> None:
    async with on_screen(make_app("student")) as pilot:
        for page in (KeySheet, GlossaryScreen, HelpScreen, Playground):
            await press(pilot, "question_mark")
            assert isinstance(pilot.app.screen, page)
        for keys, page in ((("question_mark", "3"), HelpScreen), (("2",), GlossaryScreen)):
            await press(pilot, *keys)
            assert isinstance(pilot.app.screen, page)
        await press(pilot, "escape", "question_mark", "slash")
        assert isinstance(pilot.app.screen, FindScreen)
