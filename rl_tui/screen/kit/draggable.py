"""A handle that follows the pointer while it is held."""

from __future__ import annotations

from textual import events
from textual.widget import Widget


class Draggable(Widget):
    """A widget that can be dragged along its row. Subclasses call ``take_hold`` and define ``drag_to``."""

    _held = False

    @property
    def is_held(self) -> bool:
        """Whether the handle is held."""
        return self._held

    def drag_to(self, column: int) -> None:
        """Let the handle go to ``column``, which may lie past either end."""
        raise NotImplementedError

    def take_hold(self, column: int) -> None:
        """Let the handle jump to ``column`` and follow the pointer until the button is let go."""
        self._held = True
        self.capture_mouse()
        self.drag_to(column)

    def on_mouse_move(self, event: events.MouseMove) -> None:
        """Follow the pointer while the handle is held, past the ends too."""
        if self._held:
            self.drag_to(event.get_content_offset_capture(self).x)

    def on_mouse_up(self) -> None:
        """Let the handle go."""
        if self._held:
            self._held = False
            self.release_mouse()

    def on_mouse_release(self) -> None:
        """Let the handle go where another widget took the mouse."""
        self._held = False
