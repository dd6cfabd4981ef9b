"""A box over the playground or the catalogue, closed by escape."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar, TypeVar

from textual.binding import Binding, BindingType
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

    def action_cancel(self) -> None:
        """Close without an answer."""
        self.dismiss(None)
