"""What is pointed at: a cursor shows in other panels where it is, and a handle follows the pointer."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from textual import events
from textual.message import Message
from textual.widget import Widget

NOWHERE: Final = range(0)


class Touched(Message):
    """Something was pointed at, drawn or pressed that a mode may have a use for."""


@dataclass
class Pointed(Touched):
    """The cursor of ``panel`` was moved to ``pairs``, those of a state or one; none without a cursor."""

    panel: Widget
    pairs: range


@dataclass
class Moved(Message):
    """A person brought another part or another layer into view in ``panel``, without a cursor."""

    panel: Widget


@dataclass
class PartPointed(Touched):
    """The place under the cursor was clicked again, in its middle (None) or ``step`` from there."""

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


class Draggable(Widget):
    """A widget that can be dragged along its row. Subclasses call ``take_hold`` and define ``drag_to``."""

    is_held = False

    def drag_to(self, column: int) -> None:
        """Let the handle go to ``column``, which may lie past either end."""
        raise NotImplementedError

    def take_hold(self, column: int) -> None:
        """Let the handle jump to ``column`` and follow the pointer until the button is let go."""
        self.is_held = True
        self.capture_mouse()
        self.drag_to(column)

    def on_mouse_move(self, event: events.MouseMove) -> None:
        """Follow the pointer while the handle is held, past the ends too."""
        if self.is_held:
            self.drag_to(event.get_content_offset_capture(self).x)

    def on_mouse_up(self) -> None:
        """Let the handle go."""
        if self.is_held:
            self.is_held = False
            self.release_mouse()

    def on_mouse_release(self) -> None:
        """Let the handle go where another widget took the mouse."""
        self.is_held = False
