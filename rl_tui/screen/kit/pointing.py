"""A cursor in one panel shows in the others where it stands."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Protocol

from textual.geometry import Size
from textual.message import Message
from textual.widget import Widget

NOWHERE: Final = range(0)
_MIDDLE: Final = 0.2  # of half a place


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


class PlacePicture(Protocol):
    """A picture of places."""

    @property
    def size(self) -> Size:
        """How many columns and rows it has."""

    def place_at(self, x: int, y: int) -> int | None:
        """Return the place drawn at column ``x`` of row ``y``, None where there is none."""


def part_pointed_at(places: PlacePicture, x: int, y: int) -> tuple[int, int] | None:
    """Return towards which side of its place column ``x`` of row ``y`` is, None in the middle."""
    here = places.place_at(x, y)
    columns = [each for each in range(places.size.width) if places.place_at(each, y) == here]
    rows = [each for each in range(places.size.height) if places.place_at(x, each) == here]
    right, down = _off_centre(x, columns), _off_centre(y, rows)
    if max(abs(right), abs(down)) < _MIDDLE:
        return None
    if abs(right) >= abs(down):
        return 0, (1 if right > 0 else -1)
    return (1 if down > 0 else -1), 0


def _off_centre(at: int, cells: list[int]) -> float:
    """Return how far from the middle of ``cells`` one of them is, from −1 to 1."""
    return (2 * at - cells[0] - cells[-1]) / len(cells)
