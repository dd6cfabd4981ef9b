"""Failures at the end of the program."""

from __future__ import annotations

import pytest
from conftest import MakeApp
from seams import on_screen
from textual.css.query import NoMatches
from textual.widget import MountError

from rl_tui.screen.app.app import RlTuiApp
from rl_tui.screen.playground.playground import Playground
from rl_tui.screen.terminal.ending import HUNG_UP
from rl_tui.screen.terminal.linked_app import is_open


@pytest.mark.parametrize("by_worker", [False, True])
@pytest.mark.parametrize("fault", [NoMatches("the widgets go first"), MountError("nothing to mount on")])
async def test_a_screen_that_opens_while_the_program_ends_is_no_bug(
    fault: Exception, by_worker: bool
) -> None:
    async def look_for_what_is_gone() -> None:
        raise fault

    app = RlTuiApp()
    async with app.run_test():
        app.exit(return_code=HUNG_UP)
        if by_worker:
            app.run_worker(look_for_what_is_gone)  # type: ignore[arg-type]  # it may not begin any more
        else:
            app.call_later(look_for_what_is_gone)
    assert (app.bug, app.return_code) == (None, HUNG_UP)


async def test_nothing_more_is_drawn_while_the_program_ends(
    make_app: MakeApp, monkeypatch: pytest.MonkeyPatch
) -> None:
    app = make_app("student")
    was_here = []

    async def close_all() -> None:
        was_here.append(is_open(screen))
        await close()

    async with on_screen(app):
        screen, close = app.screen, app._close_all
        assert isinstance(screen, Playground)
        assert is_open(screen)
        monkeypatch.setattr(app, "_close_all", close_all)
    assert was_here == [False]
