"""What there is to draw with in one kind of world: a row a tool."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.tui.panels.drawing.sheet import SheetLine, ToolCell, WorldNumber
from rl_tui.tui.panels.world.view import WorldView
from rl_tui.tui.screens.dialogs.dialog import Dialog
from rl_tui.tui.screens.key_line import Hints
from rl_tui.tui.theme.glyphs import Glyphs
from rl_tui.worlds.editing.draft import Draft
from rl_tui.worlds.editing.edit import Edit
from rl_tui.worlds.world import World


@dataclass(frozen=True, slots=True)
class Desk:
    """What a tool works with: the picture, the newest snapshot, what is drawn, and the ways to speak."""

    view: WorldView
    snapshot: Snapshot
    draft: Draft
    glyphs: Glyphs
    draw: Callable[[Sequence[Edit]], None]
    tell: Callable[[str], None]
    ask: Callable[[Dialog[Any], Callable[[Any], None]], None]


@dataclass(frozen=True, slots=True)
class Tool:
    """One thing to draw with.

    ``key`` is Textual's name of its key, empty where it has none, ``shown`` how people see it, ``word`` a
    word for key line and panel, ``help`` a sentence for the palette. ``use`` gets the toolbox, or whatever
    the tool belongs to, and the desk; ``click`` is what a click on it does instead. ``rank`` orders the key
    line; None: it is not there. Where it is not ``in_panel``, the panel says otherwise what it does. ``name``
    is what palette and docs call it, where the word alone says too little.
    """

    key: str
    shown: str
    word: str
    help: str
    use: Callable[[Any, Desk], None]
    rank: int | None = None
    click: Callable[[Any, Desk], None] | None = None
    in_panel: bool = True
    name: str = ""

    @property
    def id(self) -> str:
        """By what it is asked for."""
        return self.key or self.word

    @property
    def label(self) -> str:
        """What it is called where it stands alone."""
        return self.name or self.word


class Toolbox(ABC):
    """The tools of one kind of world, and what is remembered between two of them."""

    tools: ClassVar[tuple[Tool, ...]]

    def hints(self) -> Hints:
        """Return the keys for the key line."""
        ranked = sorted(
            (each for each in self.tools if each.rank is not None), key=lambda each: each.rank or 0
        )
        return tuple((each.shown, each.word) for each in ranked)

    @abstractmethod
    def about(self, desk: Desk) -> tuple[str, ...]:
        """Return what stands under the cursor, the longest form first."""

    @property
    def in_hand(self) -> str:
        """What there is to paint with, empty where nothing is."""
        return ""

    def advice(self, desk: Desk) -> tuple[str, ...]:
        """Return what a click does now, the longest form first."""
        return ()

    def lines(self, desk: Desk) -> tuple[SheetLine, ...]:
        """Return lines to choose from, what tools are about besides the place under the cursor."""
        return ()

    def choose_line(self, desk: Desk, line: int) -> None:
        """Choose one of them."""
        raise NotImplementedError

    def cell(self, tool: Tool, desk: Desk) -> ToolCell:
        """Return how the panel shows ``tool`` now."""
        return ToolCell(tool.id, tool.shown, tool.word)

    def numbers(self, desk: Desk) -> tuple[WorldNumber, ...]:
        """Return the numbers that have a slider."""
        return ()

    def number_edits(self, desk: Desk, name: str, value: float) -> Sequence[Edit]:
        """Return the edits that set one of them. Raises ValueError, in words, where it cannot be that."""
        raise NotImplementedError

    def picked(self, desk: Desk) -> frozenset[int]:
        """Return the places that the next tool is about, besides the one under the cursor."""
        return frozenset()

    @abstractmethod
    def paint(self, desk: Desk, places: Sequence[int]) -> None:
        """Draw at the ``places`` over which the pointer was drawn, or that was clicked."""

    @abstractmethod
    def turn(self, desk: Desk, place: int, amount: float) -> None:
        """Change what a place pays, by the wheel."""

    def go_along(self, desk: Desk, step: tuple[int, int]) -> None:
        """Do what shift and an arrow mean, a step (rows down, columns right): move, if nothing more."""
        place = desk.view.cursor_place
        if place is not None:
            desk.view.put_cursor(desk.view.moved(place, *step))

    def cancel(self) -> bool:
        """Forget what was begun and not ended; return whether there was something."""
        return False

    def place_added(self, world: World) -> int | None:
        """Return the place of what a tool has added, the first time that it is in ``world``; else None."""
        return None
