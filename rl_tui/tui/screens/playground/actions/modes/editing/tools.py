"""What there is to draw with in one kind of world: a row a key."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from rl_tui.lab.live.commands import Command
from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.tui.panels.world.view import WorldView
from rl_tui.tui.screens.dialogs.dialog import Dialog
from rl_tui.tui.screens.key_line import Hints
from rl_tui.tui.theme.glyphs import Glyphs
from rl_tui.worlds.editing.draft import Draft
from rl_tui.worlds.editing.edit import Edit


@dataclass(frozen=True, slots=True)
class Hand:
    """What a tool works with: the picture, the newest snapshot, and the ways to speak."""

    view: WorldView
    snapshot: Snapshot
    glyphs: Glyphs
    send: Callable[[Command], None]
    draw: Callable[[Sequence[Edit]], None]
    tell: Callable[[str], None]
    ask: Callable[[Dialog[Any], Callable[[Any], None]], None]

    @property
    def draft(self) -> Draft:
        """What is drawn; there is a draft wherever tools are at work."""
        draft = self.snapshot.editor.draft
        assert draft is not None
        return draft


@dataclass(frozen=True, slots=True)
class Tool:
    """One key of the mode.

    ``key`` is Textual's name of it, ``shown`` how people see it, ``word`` a word for the key line, ``help`` a
    sentence for the palette. ``rank`` orders the key line; None: it is not there.
    """

    key: str
    shown: str
    word: str
    help: str
    use: Callable[[Any, Hand], None]
    rank: int | None = None


class Toolbox(ABC):
    """The tools of one kind of world, and what is remembered between two of them."""

    tools: ClassVar[tuple[Tool, ...]]

    def tool(self, key: str) -> Tool | None:
        """Return what ``key`` means, None for nothing."""
        return next((each for each in self.tools if each.key == key), None)

    def hints(self) -> Hints:
        """Return the keys for the key line."""
        ranked = sorted(
            (each for each in self.tools if each.rank is not None), key=lambda each: each.rank or 0
        )
        return tuple((each.shown, each.word) for each in ranked)

    @abstractmethod
    def about(self, hand: Hand) -> tuple[str, ...]:
        """Return what stands under the cursor, the longest form first."""

    def picked(self, hand: Hand) -> frozenset[int]:
        """Return the places that the next tool is about, besides the one under the cursor."""
        return frozenset()

    @abstractmethod
    def paint(self, hand: Hand, places: Sequence[int]) -> None:
        """Draw at the ``places`` over which the pointer was drawn, or that was clicked."""

    @abstractmethod
    def turn(self, hand: Hand, place: int, amount: float) -> None:
        """Change what a place pays, by the wheel."""
