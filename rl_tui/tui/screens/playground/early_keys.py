"""Keys typed before there is a world: what needs one waits for it, and so does all that is typed after."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Final

from textual.app import App
from textual.events import Key

from rl_tui.tui.actions.action import Action

_MOST: Final = 100  # keys: who types more than that ahead is not a person


class EarlyKeys:
    """Holds keys back from the first one on that is for one of ``actions`` that need a world."""

    def __init__(self, actions: Iterable[Action]) -> None:
        self._waiting = frozenset(key for action in actions if action.needs_world for key in action.keys)
        self._held: list[Key] = []

    def take(self, event: Key) -> bool:
        """Hold ``event`` back, if it has to wait; escape does not, and ends the waiting."""
        if event.key == "escape" or event.key.startswith("ctrl+"):
            self._held.clear()
            return False
        if not self._held and event.key not in self._waiting:
            return False
        if len(self._held) < _MOST:
            self._held.append(event)
        return True

    def release(self, app: App[Any]) -> None:
        """Let ``app`` have the keys again, now that there is a world."""
        held, self._held = self._held, []
        for key in held:
            app.post_message(Key(key.key, key.character))
