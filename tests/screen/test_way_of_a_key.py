"""The number of functions that run for a key."""

from __future__ import annotations

import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

import pytest
from playing import note_function
from seams import app_at, on_screen, press, slider
from textual.pilot import Pilot

from rl_tui.runs.library import find, recipe_for

WAITING = (
    "settle",
    "_commands_sent",
    "Frames._carried_out",
    "Frames.settled",
    "Player.carried_out",
    "_Question.",
    "Player.unanswered",
    "Playground._show_unanswered",
    "WaitingRow.show_unanswered",
)
"""Functions that a key does not run: a test and `screenshot` wait with them, or a timer calls them."""


class Way:
    def __init__(self) -> None:
        self.functions: set[tuple[str, str]] | None = None

    async def of(self, pilot: Pilot[Any], key: str) -> set[tuple[str, str]]:
        found, before = set[tuple[str, str]](), sys.getprofile()
        sys.setprofile(self.note)
        self.functions = found
        await press(pilot, key)
        self.functions = None
        sys.setprofile(before)
        return found

    def note(self, frame: FrameType, event: str, _: object) -> None:
        if self.functions is not None and not frame.f_code.co_qualname.startswith(WAITING):
            note_function(self.functions, frame, event)


@contextmanager
def noted_way() -> Iterator[Way]:
    """Note the functions of threads that begin meanwhile. For this thread, use :meth:`Way.of`."""
    way = Way()
    threading.setprofile(way.note)
    try:
        yield way
    finally:
        threading.setprofile(None)


@pytest.mark.usefixtures("real_frames")
@pytest.mark.parametrize(
    ("key", "functions", "files"),
    [("s", 565, 110), ("b", 600, 110), ("right", 615, 110)],
    ids=["step", "back", "slider"],
)
async def test_few_functions_run_for_a_key(key: str, functions: int, files: int) -> None:
    """Keep the way of a key short.

    The limits leave room for what depends on the machine: how far compiling has come, and whether a step
    back finds its position kept or replays a few steps.
    """
    seen = "Slider.set_value" if key == "right" else "Playback.snapshot"
    with noted_way() as way:
        async with on_screen(app_at(recipe_for(find("frozenlake"))), (120, 40)) as pilot:
            await press(pilot, *"ssssssssssss")
            if key == "right":
                slider(pilot.app, "alpha").focus()
            await press(pilot, key, key)  # one-time reads and builds do not count
            ran = set.intersection(*[await way.of(pilot, key) for _ in range(4)])
    assert {"Playground.redraw", "Board.show", seen} <= {name for _, name in ran}
    assert len(ran) <= functions
    assert len({file for file, _ in ran}) <= files
