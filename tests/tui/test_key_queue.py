"""Keys that are held back until those before them are done."""

from __future__ import annotations

import asyncio

import pytest
from textual.app import App, ComposeResult
from textual.events import Event, Key, MouseUp, Paste
from textual.widgets import Input

from rl_tui.terminal.key_queue import EscapeOrAlt, KeyQueue
from rl_tui.tui.app.app import RlTuiApp
from rl_tui.tui.app.idleness import Idleness


async def test_of_a_flood_of_keys_only_so_many_are_held() -> None:
    app = App[None]()
    handled: list[Event] = []

    async def handle(event: Event) -> None:
        handled.append(event)

    async with app.run_test() as pilot:
        queue = KeyQueue(app, handle, most=3)
        keys = [Key(letter, letter) for letter in "abcdefgh"]
        for key in keys:
            await queue.take(key)
        async with asyncio.timeout(60):
            while len(handled) < 4:
                await pilot.pause()
        await queue.take(keys[-1])  # there is room again
        async with asyncio.timeout(60):
            while len(handled) < 5:
                await pilot.pause()
    assert handled == [*keys[:4], keys[-1]]


async def test_a_flood_lets_other_things_happen_too(monkeypatch: pytest.MonkeyPatch) -> None:
    app = RlTuiApp()
    happened: list[str] = []

    def note(_: Idleness) -> None:
        if not happened:
            asyncio.get_running_loop().call_soon(happened.append, "something else")
        happened.append("input")

    async with app.run_test():
        monkeypatch.setattr(Idleness, "stir", note)
        for x in range(3):
            await app.on_event(MouseUp(None, x, 0, 0, 0, 0, False, False, False))
    assert happened[:3] == ["input", "something else", "input"]


@pytest.mark.parametrize("has_entry", [True, False])
async def test_what_may_be_two_keys_is_one_where_that_does_something(has_entry: bool) -> None:
    class Asking(App[None]):
        def compose(self) -> ComposeResult:
            if has_entry:
                yield Input()

    app = Asking()
    handled: list[Event] = []

    async def handle(event: Event) -> None:
        handled.append(event)

    async with app.run_test() as pilot:
        queue = KeyQueue(app, handle)
        await queue.take(EscapeOrAlt("ctrl+w", Key("backspace", "\x7f")))
        await queue.take(Key("s", "s"))
        async with asyncio.timeout(60):
            while not (handled and isinstance(handled[-1], Key) and handled[-1].key == "s"):
                await pilot.pause()
    keys = [event.key for event in handled if type(event) is Key]
    assert keys == (["ctrl+w", "s"] if has_entry else ["escape", "backspace", "s"])


async def test_a_paste_counts_by_its_characters_and_a_loss_is_told_once() -> None:
    app = App[None]()
    handled: list[Event] = []
    told: list[str] = []

    async def handle(event: Event) -> None:
        handled.append(event)

    async with app.run_test() as pilot:
        queue = KeyQueue(app, handle, most=3, tell_of_loss=lambda: told.append("lost"))
        events = [Key("a", "a"), Paste("four"), Key("b", "b"), Paste("more")]
        for event in events:
            await queue.take(event)
        async with asyncio.timeout(60):
            while len(handled) < 2:
                await pilot.pause()
    assert handled == events[:2]
    assert told == ["lost"]
