"""A cursor in one panel shows in the others where it stands."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from textual.message import Message
from textual.widget import Widget

NOWHERE: Final = range(0)


class Touched(Message):
    """Something was pointed at, drawn or pressed that a mode may have a use for."""


@dataclass
class Pointed(Touched):
    """The cursor of ``panel`` was moved to what ``pairs`` are: those of a state, or one by itself.

    They are empty where there is no cursor any more, or where it stands on no pair.
    """

    panel: Widget
    pairs: range


@dataclass
class Moved(Message):
    """A person brought another part or another layer into view in ``panel``, without a cursor."""

    panel: Widget


@dataclass
class PartPointed(Touched):
    """The place under the cursor of ``panel`` was clicked again.

    ``step`` says in which part of it, as a step (rows down, columns right) towards there; None: the middle.
    """

    panel: Widget
    step: tuple[int, int] | None


@dataclass
class PointerStroke(Touched):
    """The pointer was pressed in ``view``, drawn over these ``places``, at least one, and let go."""

    view: Widget
    places: tuple[int, ...]


@dataclass
class Wheeled(Touched):
    """The wheel was turned over a ``place`` of ``view`` that is drawn on: by ±1, or by ±0.1 with shift."""

    view: Widget
    place: int
    amount: float
