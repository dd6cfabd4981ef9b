"""What the command palette offers: every action of the screen beneath it, and the themes."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from functools import partial
from typing import Final, NamedTuple, Protocol, runtime_checkable

from textual.command import DiscoveryHit, Hit, Hits, Provider
from textual.content import Content
from textual.screen import Screen
from textual.style import Style

from rl_tui.screen.draw.to_ascii import to_ascii
from rl_tui.screen.keys.action import Action
from rl_tui.screen.theme.look import Look

NOTHING_FOUND: Final = "No action has a word that begins so. Enter shows every key."
_MARK: Final = Style(reverse=True)
_DIM: Final = Style(dim=True)
_WORD: Final = re.compile(r"^\W+|\W+$")


@runtime_checkable
class HasActions(Protocol):
    """A screen that says what can be done on it."""

    look: Look

    @property
    def actions(self) -> tuple[Action, ...]:
        """What a person can do there."""

    def help_screen(self, *, at_keys: bool = False) -> Screen[None]:
        """Return the help, from its first line on or from the keys on."""


class PaletteEntry(NamedTuple):
    """What is listed, the sentence about it, what it does, and other words for it.

    One that ``is_refused`` can do nothing now, as its sentence says: it is dim, and says so when chosen.
    """

    name: str
    sentence: str
    do: Callable[[], object]
    aliases: str = ""
    is_refused: bool = False


def relevance(query: str, entry: PaletteEntry) -> float:
    """Return how well ``query`` fits ``entry``, from 0 (not at all) to 1.

    Each word of it has to begin a word of the entry, or to stand somewhere in its name: letters strewn over
    a sentence, which Textual takes too, find something for everything.
    """
    words = _words(query)
    return min((_weight(word, entry) for word in words), default=0.0)


def _weight(word: str, entry: PaletteEntry) -> float:
    name = _words(entry.name)
    if word in name:
        return 1.0
    if any(each.startswith(word) for each in name):
        return 0.9 if name[0].startswith(word) else 0.8
    if any(each.startswith(word) for each in _words(entry.aliases)):
        return 0.7
    if (len(word) > 1 or not word.isalnum()) and word in entry.name.lower():
        return 0.5
    return 0.3 if any(each.startswith(word) for each in _words(entry.sentence)) else 0.0


def _words(text: str) -> list[str]:
    """Return the words of ``text`` in small letters; what has none of them, such as a key, is one itself."""
    return [_WORD.sub("", each) or each for each in text.lower().split()]


def _marked(entry: PaletteEntry, query: str = "", style: Style | None = None) -> Content:
    """Return the name of ``entry`` with what was searched for marked in it."""
    content = Content(entry.name)
    if entry.is_refused:
        content = content.stylize(_DIM)
    for word in _words(query):
        start = entry.name.lower().find(word)
        if start >= 0:
            content = content.stylize(style or _MARK, start, start + len(word))
    return content


class ActionProvider(Provider):
    """The palette entries: every action of the screen beneath the palette, and the themes."""

    async def discover(self) -> Hits:
        """Yield every entry, for an empty search."""
        for entry in self._entries():
            yield DiscoveryHit(_marked(entry), entry.do, help=entry.sentence)

    async def search(self, query: str) -> Hits:
        """Yield the entries that ``query`` is about; where there is none, one that says so and helps."""
        found = False
        for entry in self._entries():
            score = relevance(query, entry)
            if score > 0.0:
                found = True
                yield Hit(score, _marked(entry, query, self.match_style), entry.do, help=entry.sentence)
        if not found:
            yield Hit(1.0, "Nothing found", self._show_keys, help=NOTHING_FOUND)

    def _show_keys(self) -> None:
        screen = self.screen
        if isinstance(screen, HasActions):
            self.app.push_screen(screen.help_screen(at_keys=True))

    def _entries(self) -> Iterator[PaletteEntry]:
        screen = self.screen
        if isinstance(screen, HasActions):
            for action in screen.actions:
                name, sentence = (
                    to_ascii(text, screen.look.glyphs) for text in (palette_name(action), action.sentence)
                )
                do = partial(screen.run_action, action.textual_action)
                yield PaletteEntry(name, sentence, do, action.aliases, is_refused=bool(action.refused))
        yield PaletteEntry("Theme", "Choose the colours.", self.app.action_change_theme, "color dark light")


def palette_name(action: Action) -> str:
    """Return how the palette lists ``action``: the word and its key."""
    name = f"{action.label[0].upper()}{action.label[1:]}"
    return f"{name} ({action.shown})" if action.shown else name
