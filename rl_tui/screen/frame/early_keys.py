"""Keys typed before what they are for is there: they wait for it, and so does all that is typed after."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Final

from textual.app import App
from textual.events import Key

from rl_tui.screen.terminal.key_queue import TypeFirst

_MOST: Final = 100  # keys: who types more than that ahead is not a person


class EarlyKeys:
    """Holds keys back from the first one on that is among ``waiting``, until they are released."""

    def __init__(self, waiting: Iterable[str]) -> None:
        self._waiting = frozenset(waiting)
        self._held: list[Key] = []
        self._is_released = self._is_over = False

    def add(self, key: str) -> None:
        """Hold ``key`` as if it had been typed."""
        self._held.append(Key(key, None))

    def take(self, event: Key) -> bool:
        """Hold ``event`` back, if it has to wait; escape does not, and ends the waiting."""
        if event.key == "escape" or event.key.startswith("ctrl+"):
            self._held.clear()
            return False
        if self._is_over or not (self._held or event.key in self._waiting):
            return False
        if len(self._held) < _MOST:
            self._held.append(event)
        return True

    def release(self, app: App[Any]) -> None:
        """Let ``app`` have the keys again, now that what they are for is there.

        Those already on their way are held as well, or they would come first.
        """
        if not self._is_released:
            self._is_released = True
            app.post_message(TypeFirst(self._end))

    def _end(self) -> list[Key]:
        self._is_over = True
        return [Key(each.key, each.character) for each in self._held]
