"""A box over the playground or the catalogue, closed by escape."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar, Final, TypeVar

from rich.cells import cell_len
from textual.binding import Binding, BindingType
from textual.containers import Vertical
from textual.content import Content
from textual.events import Click
from textual.screen import ModalScreen

from rl_tui.terminal.linked_app import LinkedApp
from rl_tui.tui.panels.panel import key_at

Result = TypeVar("Result")
_BORDER_END: Final = 3  # a blank, a piece of line and the corner


class Dialog(ModalScreen[Result | None]):
    """A modal screen whose content stands in a bordered box with the id ``box``; escape answers nothing."""

    # absolute: Textual looks for it beside the subclass, which may stand in another folder
    CSS_PATH = Path(__file__).with_name("dialog.tcss")
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("escape", "cancel", "back", id="cancel", tooltip="Close without a change."),
    ]

    def on_mount(self) -> None:
        """Leave what lies behind as it is where to darken it, and undo that, would take long."""
        self.set_class(isinstance(self.app, LinkedApp) and self.app.has_slow_link, "-slow")

    @staticmethod
    def box(title: str, keys: str, classes: str | None = None) -> Vertical:
        """Return the box, with ``title`` above it and the ``keys`` below."""
        box = Vertical(id="box", classes=classes)
        box.border_title, box.border_subtitle = Content(title), keys
        return box

    def on_click(self, event: Click) -> None:
        """Press the key that is written where the lower border was clicked."""
        for box in self.query("#box"):
            keys, region = str(box.border_subtitle), box.region
            column = event.screen_x - (region.right - _BORDER_END - cell_len(keys))
            key = key_at(keys, column) if event.screen_y == region.bottom - 1 else None
            if key is not None:
                event.stop()
                # by the app: what a screen sends does not rise beyond it, to where bindings are looked up
                self.app.call_later(self.app.simulate_key, key)

    def action_cancel(self) -> None:
        """Close without an answer."""
        self.dismiss(None)
