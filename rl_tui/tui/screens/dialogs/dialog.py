"""A box over the playground or the catalogue, closed by escape."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar, TypeVar

from textual.binding import Binding, BindingType
from textual.containers import Vertical
from textual.content import Content
from textual.screen import ModalScreen

from rl_tui.terminal.linked_app import LinkedApp

Result = TypeVar("Result")


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

    def action_cancel(self) -> None:
        """Close without an answer."""
        self.dismiss(None)
