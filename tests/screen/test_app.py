from __future__ import annotations

import asyncio
from functools import partial
from pathlib import Path

import pytest
from conftest import MakeApp
from seams import on_screen, screen_text, tap
from textual.geometry import Region

from rl_tui.common.errors import UserError
from rl_tui.live.player import Player
from rl_tui.runs.library import recipe_for
from rl_tui.screen.app.app import RlTuiApp
from rl_tui.screen.app.display import Display
from rl_tui.screen.app.screenshot import settle
from rl_tui.screen.kit.panel import BoardPanel
from rl_tui.screen.playground.playground import Playground
from rl_tui.worlds.files.scenario import read_scenario

NOT_REGISTERED = """
title = "Nowhere"
[gymnasium]
id = "Nowhere-v0"
"""


@pytest.mark.parametrize(
    "scenario", [None, pytest.param("student", marks=pytest.mark.exhaustive("another screen"))]
)
async def test_a_small_terminal_is_told_so_and_recovers_and_q_quits(
    make_app: MakeApp, scenario: str | None
) -> None:
    app = make_app(scenario)
    async with on_screen(app) as pilot:
        message, keys = app.screen.query_one("#too-small"), app.screen.query_one("#keys")
        assert not message.display
        await pilot.resize_terminal(50, 15)
        while not message.display:  # styles update after a resize when the app is idle
            await pilot.pause()
        await settle(pilot)
        assert not keys.display
        assert str(message.render()) == "terminal too small: is 50×15, needs 60×18"
        await pilot.resize_terminal(59, 30)
        while str(message.render()) != "terminal too small: is 59×30, needs 60×18":
            await pilot.pause()
        await pilot.resize_terminal(60, 18)
        while message.display:
            await pilot.pause()
        assert keys.display
        await pilot.press("q")
    assert app.return_value is None
    assert app.return_code == 0


async def test_it_can_be_quit_before_anything_is_ready(make_app: MakeApp) -> None:
    app = make_app("frozenlake")
    async with app.run_test(size=(80, 24)) as pilot:
        await pilot.press("q")
    assert app.return_code == 0


async def test_the_theme_changes_colours(make_app: MakeApp) -> None:
    async with on_screen(make_app("student", theme="dark")) as pilot:
        screen = pilot.app.screen
        assert isinstance(screen, Playground)
        before = screen.board.table.look.palette
        await tap(pilot, "m", "c", "2")
        assert pilot.app.theme == "light"
        assert screen.board.table.look.palette != before
        assert screen.board.table.look.palette == pilot.app.look.palette
        heading = next(iter(screen.board.controls.render_lines(Region(0, 0, 5, 1))[0]))
        assert (heading.text, heading.style.color) == ("Agent", pilot.app.look.palette.strong.color)


def test_an_unknown_theme_is_refused_with_the_known_ones() -> None:
    with pytest.raises(UserError, match=r"theme 'mauve' is not known; choose one of .*dark.*light"):
        RlTuiApp(Display(theme="mauve"))


async def test_a_world_that_cannot_be_built_ends_what_play_started(tmp_path: Path) -> None:
    file = tmp_path / "nowhere.toml"
    file.write_text(NOT_REGISTERED)
    recipe = recipe_for(read_scenario(file, ask_environment=False), {}, 0)
    app = RlTuiApp(Display(), recipe, make_player=partial(Player, automatic=False))
    async with app.run_test():
        while app.return_value is None:
            await asyncio.sleep(0)
    assert app.return_code == 1
    assert isinstance(app.return_value, UserError)
    assert "Nowhere-v0" in str(app.return_value)


async def test_in_ascii_no_character_is_left_over(make_app: MakeApp) -> None:
    app = make_app("student", ascii=True)
    async with on_screen(app) as pilot:
        assert "v  Q  Q* - w h shows Q*" in screen_text(app)
        assert screen_text(app).isascii()
        for panel in app.screen.query(BoardPanel):  # as after narrowing, until it is fitted again
            panel.write_border("x" * 200, "x" * 200, app.look)
        await settle(pilot)
        assert screen_text(app).isascii()
        await tap(pilot, "ctrl+p", *"xyzzy")
        assert screen_text(app).isascii()
        await tap(pilot, "escape", "m", "c")
        assert "Colours" in screen_text(app)
        assert screen_text(app).isascii()
        await pilot.press("escape")
        await pilot.resize_terminal(50, 15)
        while "is 50x15, needs 60x18" not in screen_text(app):  # styles update when the app is idle
            await pilot.pause()
        assert screen_text(app).isascii()
