"""Keys that are held back until those before them are done."""

from __future__ import annotations

import asyncio

import pytest
from textual.app import App
from textual.events import Event, Key, MouseUp

from rl_tui.tui.app import RlTuiApp
from rl_tui.tui.typist import Typist


async def test_of_a_flood_of_keys_only_so_many_are_held() -> None:
    app = App[None]()
    handled: list[Event] = []

    async def handle(event: Event) -> None:
        handled.append(event)

    async with app.run_test() as pilot:
        typist = Typist(app, handle, most=3)
        keys = [Key(letter, letter) for letter in "abcdefgh"]
        for key in keys:
            await typist.take(key)
        async with asyncio.timeout(60):
            while len(handled) < 4:
                await pilot.pause()
        await typist.take(keys[-1])  # there is room again
        async with asyncio.timeout(60):
            while len(handled) < 5:
                await pilot.pause()
    assert handled == [*keys[:4], keys[-1]]


async def test_a_flood_lets_other_things_happen_too(monkeypatch: pytest.MonkeyPatch) -> None:
    app = RlTuiApp()
    happened: list[str] = []

    def note() -> None:
        if not happened:
            asyncio.get_running_loop().call_soon(happened.append, "something else")
        happened.append("input")

    async with app.run_test():
        monkeypatch.setattr(app._idleness, "stir", note)
        for x in range(3):
            await app.on_event(MouseUp(None, x, 0, 0, 0, 0, False, False, False))
    assert happened[:3] == ["input", "something else", "input"]
