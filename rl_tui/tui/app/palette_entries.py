"""What the command palette offers: every action of the screen beneath it, and the themes."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import Protocol, runtime_checkable

from textual.command import DiscoveryHit, Hit, Hits, Provider

from rl_tui.tui.actions.action import Action
from rl_tui.tui.draw.to_ascii import to_ascii
from rl_tui.tui.theme.look import Look


@runtime_checkable
class HasActions(Protocol):
    """A screen that says what can be done on it."""

    look: Look

    @property
    def actions(self) -> tuple[Action, ...]:
        """What a person can do there."""


class ActionProvider(Provider):
    """The palette entries: every action of the screen beneath the palette, and the themes."""

    async def discover(self) -> Hits:
        """Yield every entry, for an empty search."""
        for name, command, sentence in self._entries():
            yield DiscoveryHit(name, command, help=sentence)

    async def search(self, query: str) -> Hits:
        """Yield the entries whose name or sentence fits ``query``."""
        matcher = self.matcher(query)
        for name, command, sentence in self._entries():
            score = max(matcher.match(name), matcher.match(f"{name} {sentence}") * 0.5)
            if score > 0:
                yield Hit(score, matcher.highlight(name), command, help=sentence)

    def _entries(self) -> Iterator[tuple[str, Callable[[], object], str]]:
        """Yield what is listed, what is done and the sentence about it."""
        screen = self.screen
        if isinstance(screen, HasActions):
            for action in screen.actions:
                name, sentence = (
                    to_ascii(text, screen.look.glyphs) for text in (palette_name(action), action.help)
                )
                yield name, partial(self.screen.run_action, action.textual_action), sentence
        yield "Theme", self.app.action_change_theme, "Choose the colours."


def palette_name(action: Action) -> str:
    """Return how the palette lists ``action``: the word and its key."""
    return f"{action.label[0].upper()}{action.label[1:]} ({action.shown})"
