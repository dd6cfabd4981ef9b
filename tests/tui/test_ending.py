"""What may go wrong while the program ends."""

from __future__ import annotations

import pytest
from conftest import MakeApp
from textual.css.query import NoMatches

from rl_tui.terminal.ending import HUNG_UP
from rl_tui.tui.app.app import RlTuiApp
from rl_tui.tui.app.screenshot import settle
from rl_tui.tui.screens.playground.playground import Playground


def query_what_is_gone() -> None:
    raise NoMatches("the widgets go first")


async def test_a_screen_that_opens_while_the_program_ends_is_no_bug() -> None:
    app = RlTuiApp()
    async with app.run_test():
        app.exit(return_code=HUNG_UP)
        app.call_later(query_what_is_gone)
    assert (app.bug, app.return_code) == (None, HUNG_UP)


async def test_nothing_more_is_drawn_while_the_program_ends(
    make_app: MakeApp, monkeypatch: pytest.MonkeyPatch
) -> None:
    app = make_app("student")
    was_here = []

    async def close_all() -> None:
        was_here.append(screen.is_here)
        await close()

    async with app.run_test() as pilot:
        await settle(pilot)
        screen, close = app.screen, app._close_all
        assert isinstance(screen, Playground)
        assert screen.is_here
        monkeypatch.setattr(app, "_close_all", close_all)
    assert was_here == [False]
