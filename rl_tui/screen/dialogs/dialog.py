"""Boxes over another screen."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar, Final, TypeVar

from rich.cells import cell_len
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Vertical
from textual.content import Content
from textual.events import Click
from textual.screen import ModalScreen
from textual.widgets import Static

from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.kit.panel import key_at
from rl_tui.screen.terminal.linked_app import LinkedApp
from rl_tui.screen.theme.glyphs import Glyphs

Result = TypeVar("Result")
_BORDER_END: Final = 3  # a blank, a piece of line and the corner


class Dialog(ModalScreen[Result | None]):
    """A modal screen with a ``box``, closed by escape."""

    # absolute, because Textual looks in the folder of the subclass
    CSS_PATH = Path(__file__).with_name("dialog.tcss")
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("escape", "cancel", "back", id="cancel", tooltip="Close without a change."),
    ]

    def on_mount(self) -> None:
        """Keep the screen undimmed on a slow link: dimming costs time."""
        self.set_class(isinstance(self.app, LinkedApp) and self.app.has_slow_link, "-slow")

    @staticmethod
    def box(title: str, keys: str, classes: str | None = None) -> Vertical:
        """Return the box with ``title`` and ``keys``."""
        box = Vertical(id="box", classes=classes)
        box.border_title, box.border_subtitle = Content(title), keys
        return box

    def on_click(self, event: Click) -> None:
        """Press the clicked key."""
        for box in self.query("#box"):
            keys, region = str(box.border_subtitle), box.region
            column = event.screen_x - (region.right - _BORDER_END - cell_len(keys))
            key = key_at(keys, column) if event.screen_y == region.bottom - 1 else None
            if key is not None:
                event.stop()
                # by the app: messages of a screen do not reach the bindings of the app
                self.app.call_later(self.app.simulate_key, key)

    def show(self, snapshot: Snapshot) -> None:
        """Show the newest snapshot."""

    def action_cancel(self) -> None:
        """Close without an answer."""
        self.dismiss(None)


class Confirm(Dialog[bool]):
    """A question. Enter answers True, escape None."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("enter", "confirm", "yes", id="confirm", tooltip="Do it."),
    ]

    def __init__(self, title: str, question: str, verb: str, glyphs: Glyphs) -> None:
        super().__init__()
        self._title = title
        self._question = question
        self._verb = verb
        self._glyphs = glyphs

    def compose(self) -> ComposeResult:
        """Yield the question."""
        with self.box(self._glyphs.spelled(self._title), f"enter: {self._verb}   esc: close"):
            yield Static(self._glyphs.spelled(self._question), markup=False)

    def action_confirm(self) -> None:
        """Answer yes."""
        self.dismiss(True)


class QuitQuestion(Confirm):
    """The question after ctrl+c, which a second ctrl+c answers."""

    def __init__(self, glyphs: Glyphs) -> None:
        super().__init__("Quit?", "ctrl+c again quits, too.", "quit", glyphs)
