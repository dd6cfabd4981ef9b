"""Messages about pointer and cursors."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from textual import events
from textual.message import Message
from textual.widget import Widget

NOWHERE: Final = range(0)


class Touched(Message):
    """A person pointed, drew or pressed."""


@dataclass
class Pointed(Touched):
    """The cursor moved to ``pairs``, empty without a cursor."""

    panel: Widget
    pairs: range


@dataclass
class Moved(Message):
    """A person changed part or layer without a cursor."""

    panel: Widget


@dataclass
class PartPointed(Touched):
    """The cursor's cell was clicked again, ``step`` from its middle."""

    panel: Widget
    step: tuple[int, int] | None


@dataclass
class PointerStroke(Touched):
    """The pointer was drawn over ``places``."""

    view: Widget
    places: tuple[int, ...]


@dataclass
class Wheeled(Touched):
    """The wheel turned by ±1 or, with shift, ±0.1."""

    view: Widget
    place: int
    amount: float


class Draggable(Widget):
    """A widget with a handle in its row. Subclasses define ``drag_to`` and call ``take_hold``."""

    is_held = False

    def drag_to(self, column: int) -> None:
        """Move the handle, possibly past an end."""
        raise NotImplementedError

    def take_hold(self, column: int) -> None:
        """Move the handle, then follow the pointer."""
        self.is_held = True
        self.capture_mouse()
        self.drag_to(column)

    def on_mouse_move(self, event: events.MouseMove) -> None:
        """Move the held handle."""
        if self.is_held:
            self.drag_to(event.get_content_offset_capture(self).x)

    def on_mouse_up(self) -> None:
        """Release the handle."""
        if self.is_held:
            self.is_held = False
            self.release_mouse()

    def on_mouse_release(self) -> None:
        """Release the handle if another widget takes the mouse."""
        self.is_held = False
