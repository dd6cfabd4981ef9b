"""Closed screens take no memory."""

from __future__ import annotations

import gc

from conftest import MakeApp
from seams import on_screen, tap
from textual.pilot import Pilot


def lines_kept() -> int:
    gc.collect()
    # isinstance raises for a weak proxy whose object is gone
    return sum(type(thing).__name__ == "StylesCache" for thing in gc.get_objects())


async def open_and_close_dialogs(pilot: Pilot[None]) -> int:
    for keys in (("question_mark", "escape"), ("ctrl+p", "escape"), ("w", "m", "escape")):
        await tap(pilot, *keys)
    return lines_kept()


async def test_dialogs_that_were_closed_are_forgotten(make_app: MakeApp) -> None:
    gc.freeze()  # checks only objects created later
    async with on_screen(make_app("student")) as pilot:
        # Textual itself holds the last one or two for a while. A leak would only grow
        kept = [await open_and_close_dialogs(pilot) for _ in range(9)]
        assert 0 < min(kept[5:]) <= max(kept[:3])
