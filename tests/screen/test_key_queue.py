"""Keys that wait until earlier ones are done."""

from __future__ import annotations

import asyncio

import pytest
from textual.app import App, ComposeResult
from textual.drivers.linux_driver import LinuxDriver
from textual.events import Event, Key, MouseUp, Paste
from textual.widgets import Input

from rl_tui.screen.app.app import Idleness, RlTuiApp
from rl_tui.screen.terminal.driver import MOST_WAITING, TerminalDriver
from rl_tui.screen.terminal.key_queue import FLOOD, EarlyKeys, EscapeOrAlt, KeyQueue, TypeFirst


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
        await queue.take(keys[-1])  # there is space again
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


@pytest.mark.parametrize(
    ("typed", "done"),
    [
        (["s", *"B" * FLOOD, "q"], ["s", "q"]),
        (["s", "w", *"B" * FLOOD, "q"], ["s", "w", "q"]),
        (["s", *"B" * 10_000, "q"], ["s", "q"]),
        (["s", *"ab" * 10_000, "q"], ["s", "q"]),
        (["s", *"w quickly", "q"], [*"sw quickly", "q"]),
        (["s", *"B" * (FLOOD - 1), "q"], ["s", *"B" * (FLOOD - 1), "q"]),
        (["s", *"B" * FLOOD, "s"], ["s", *"B" * FLOOD, "s"]),
    ],
)
async def test_a_key_that_stops_does_not_wait_for_a_flood(typed: list[str], done: list[str]) -> None:
    app = App[None]()
    handled: list[str] = []

    async def handle(event: Event) -> None:
        assert isinstance(event, Key)
        handled.append(event.key)

    async with app.run_test():
        queue = KeyQueue(app, handle, stops={"q"})
        for key in typed:
            await queue.take(Key(key, key))
        await queue.rest()
    assert handled == done


@pytest.mark.parametrize(
    ("waiting", "kept"), [(MOST_WAITING, ["q", "escape", "ctrl+c"]), (2 * MOST_WAITING, [])]
)
async def test_a_key_that_stops_is_not_lost_where_too_many_wait(
    waiting: int, kept: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    class Driver(TerminalDriver):
        def __init__(self) -> None:  # without a terminal
            self._app, self._sent, self._arrived = RlTuiApp(), waiting, 0

    sent: list[str] = []
    monkeypatch.setattr(LinuxDriver, "process_message", lambda _, message: sent.append(message.key))
    driver = Driver()
    for key in ("B", "q", "escape", "ctrl+c"):
        driver.process_message(Key(key, None))
    assert sent == kept


async def test_keys_that_waited_for_a_screen_come_before_those_typed_later() -> None:
    """Also before a key that is already on its way to that screen."""
    done: list[str] = []

    class Waiting(App[None]):
        early = EarlyKeys("a")

        async def on_event(self, event: Event) -> None:
            if isinstance(event, Key) and not event.is_forwarded:
                await queue.take(event)
            else:
                await super().on_event(event)

        def on_type_first(self, message: TypeFirst) -> None:
            queue.take_first(message.keys)

        def on_key(self, event: Key) -> None:
            if event.key == "b":
                self.early.release(self)
            if not self.early.take(event):
                done.append(event.key)

    app = Waiting()
    queue = KeyQueue(app, super(Waiting, app).on_event)
    async with app.run_test() as pilot:
        for key in "abc":
            app.post_message(Key(key, key))
        async with asyncio.timeout(60):
            while len(done) < 3:
                await pilot.pause()
    assert done == ["a", "b", "c"]
