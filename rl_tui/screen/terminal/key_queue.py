"""Keys one at a time: the effect of a key is complete before the next one counts.

In Textual a key passes several queues before bindings are looked up, and new screens need time to open. A key
typed meanwhile would reach the old focus.
"""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Awaitable, Callable, Collection, Iterable, Sequence
from contextlib import suppress
from functools import partial
from itertools import takewhile
from typing import Any, Final

from textual.app import App, ScreenStackError
from textual.dom import DOMNode
from textual.events import Event, Key, Paste
from textual.message import Message

PATIENCE: Final = 5.0  # seconds: a widget that hangs must not block the keyboard for ever
MOST_HELD: Final = 1_000  # keys: more than a person types ahead; limits the memory
FLOOD: Final = 20  # equal keys: it is held down, or something lies on it
_LOOK_AGAIN: Final = 0.1  # seconds: removed widgets do not answer


class EscapeOrAlt(Key):
    """Escape and a key, or a key with alt: terminals send the same."""

    def __init__(self, name: str, typed: Key) -> None:
        super().__init__(name, None)
        self.typed = typed


class TypeFirst(Message):
    """A request to type ``keys`` first."""

    def __init__(self, keys: Callable[[], Sequence[Key]]) -> None:
        super().__init__()
        self.keys = keys


class KeyQueue:
    """Gives keys and pastes to Textual's ``handle`` one at a time.

    Up to ``most`` are held meanwhile, then ``tell_of_loss`` is called once. A key of ``stops`` discards a
    flood before it.
    """

    def __init__(
        self,
        app: App[Any],
        handle: Callable[[Event], Awaitable[None]],
        most: int = MOST_HELD,
        tell_of_loss: Callable[[], object] | None = None,
        stops: Collection[str] = (),
    ) -> None:
        self._app = app
        self._handle = handle
        self._most = most
        self._tell_of_loss = tell_of_loss
        self._stops = stops
        self._held: deque[Event] = deque()
        self._held_size = 0
        self._first: list[Callable[[], Sequence[Key]]] = []
        self._settling: asyncio.Task[None] | None = None
        self._has_rest = asyncio.Event()
        self._has_rest.set()

    async def rest(self) -> None:
        """Wait until all keys are done."""
        await self._has_rest.wait()

    async def take(self, event: Event) -> None:
        """Handle ``event`` after all earlier keys."""
        if self._settling is None:
            await self._type(event)
            return
        if isinstance(event, Key) and event.key in self._stops:
            self._end_flood()
        if self._held_size < self._most:
            self._held.append(event)
            self._held_size += _size(event)
        elif self._tell_of_loss is not None:
            tell, self._tell_of_loss = self._tell_of_loss, None
            tell()

    def take_first(self, keys: Callable[[], Sequence[Key]]) -> None:
        """Type a message's keys first."""
        self._first.append(keys)
        if self._settling is None:
            self._has_rest.clear()
            self._settling = asyncio.create_task(self._settle(self._in_focus()), name="key-queue")

    def _hold(self, keys: Sequence[Key]) -> None:
        self._held.extendleft(each.set_sender(self._app) for each in reversed(keys))
        self._held_size += len(keys)

    def _end_flood(self) -> None:
        """Drop all held keys if full, else a last key that was typed many times."""
        if self._held_size >= self._most:
            self._held.clear()
            self._held_size = 0
        elif self._held and isinstance(last := self._held[-1], Key):
            repeated = sum(1 for _ in takewhile(partial(_is_key, last.key), reversed(self._held)))
            for _ in range(repeated if repeated >= FLOOD else 0):
                self._held.pop()
                self._held_size -= 1

    async def _type(self, event: Event) -> None:
        if isinstance(event, EscapeOrAlt):
            event = self._first_of(event)
        aim = self._in_focus()
        self._has_rest.clear()
        await self._handle(event)
        self._settling = asyncio.create_task(self._settle(aim), name="key-queue")

    def _first_of(self, event: EscapeOrAlt) -> Key:
        if event.key in self._app.active_bindings:
            return Key(event.key, event.character)
        self._hold([event.typed])
        return Key("escape", "\x1b")

    async def _settle(self, aim: DOMNode) -> None:
        with suppress(TimeoutError, ScreenStackError):  # no screen: the program is ending
            async with asyncio.timeout(PATIENCE):
                await self._pass_through(aim)
                await self._follow_focus()
                if self._held and _is_key("enter", self._held[0]):
                    await self._find_entries()
        while self._first:
            self._hold(self._first.pop()())  # the earliest end up in front
        if not (self._held and self._app.call_later(self._type_next)):
            self._settling = None
            self._has_rest.set()

    async def _type_next(self) -> None:
        event = self._held.popleft()
        self._held_size -= _size(event)
        await self._type(event)

    async def _follow_focus(self) -> None:
        before = None
        while (now := self._in_focus()) is not before:
            before = now
            await self._pass_through(now)

    async def _pass_through(self, node: DOMNode) -> None:
        for each in node.ancestors_with_self:
            is_done = asyncio.Event()
            is_sent = each.call_later(is_done.set)
            while is_sent and not is_done.is_set() and (each is self._app or each.is_attached):
                with suppress(TimeoutError):
                    async with asyncio.timeout(_LOOK_AGAIN):
                        await is_done.wait()

    async def _find_entries(self) -> None:
        """Wait for a search, because enter opens the best match."""
        screen = self._app.screen
        if getattr(screen, "is_searching", False):
            looking = [worker.wait() for worker in self._app.workers if worker.node is screen]
            await asyncio.gather(*looking, return_exceptions=True)
            await self._pass_through(self._in_focus())

    def _in_focus(self) -> DOMNode:
        return self._app.focused or self._app.screen


def _size(event: Event) -> int:
    return len(event.text) + 1 if isinstance(event, Paste) else 1


def _is_key(key: str, event: Event) -> bool:
    return isinstance(event, Key) and event.key == key


_MOST: Final = 100  # keys: more than a person types ahead


class EarlyKeys:
    """Keys held from the first one in ``waiting`` on."""

    def __init__(self, waiting: Iterable[str]) -> None:
        self._waiting = frozenset(waiting)
        self._held: list[Key] = []
        self._is_released = self._is_over = False

    def add(self, key: str) -> None:
        """Hold ``key`` as if typed."""
        self._held.append(Key(key, None))

    def take(self, event: Key) -> bool:
        """Hold ``event`` and return True if it has to wait. Escape ends the waiting."""
        if event.key == "escape" or event.key.startswith("ctrl+"):
            self._held.clear()
            return False
        if self._is_over or not (self._held or event.key in self._waiting):
            return False
        if len(self._held) < _MOST:
            self._held.append(event)
        return True

    def release(self, app: App[Any]) -> None:
        """Type the held keys before later ones."""
        if not self._is_released:
            self._is_released = True
            app.post_message(TypeFirst(self._end))

    def _end(self) -> list[Key]:
        self._is_over = True
        return [Key(each.key, each.character) for each in self._held]
