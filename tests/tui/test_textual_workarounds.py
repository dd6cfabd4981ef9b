"""Screens that were left take no memory."""

from __future__ import annotations

import gc

from conftest import MakeApp
from textual._styles_cache import StylesCache

from rl_tui.tui.app.screenshot import settle


def lines_kept() -> int:
    """Count the widgets of which lines are kept."""
    gc.collect()
    return sum(isinstance(thing, StylesCache) for thing in gc.get_objects())


async def test_dialogs_that_were_closed_are_forgotten(make_app: MakeApp) -> None:
    async with make_app("student").run_test(size=(80, 24)) as pilot:
        await settle(pilot)
        kept = []
        for _ in range(3):
            for keys in (("question_mark", "escape"), ("ctrl+p", "escape"), ("m", "escape")):
                await pilot.press(*keys)
            await settle(pilot)
            kept.append(lines_kept())
        assert kept[2] <= kept[0]
