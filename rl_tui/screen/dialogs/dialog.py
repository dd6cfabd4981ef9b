"""Dialogs: boxes over the playground or the start screen, closed by escape.

`Dialog` is the base of all dialogs. The simple ones, which need no list of options, are also here.
"""

from __future__ import annotations

from collections.abc import Callable
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
from rl_tui.screen.draw.to_ascii import to_ascii
from rl_tui.screen.kit.panel import key_at
from rl_tui.screen.panels.model.model import ModelPanel
from rl_tui.screen.terminal.linked_app import LinkedApp
from rl_tui.screen.theme.glyphs import Glyphs
from rl_tui.screen.theme.look import Look

# The base of all dialogs


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

    def show(self, snapshot: Snapshot) -> None:
        """Show the newest snapshot, where the dialog is about the run."""

    def action_cancel(self) -> None:
        """Close without an answer."""
        self.dismiss(None)


# Yes or no


class Confirm(Dialog[bool]):
    """A question. Answers True for enter; escape answers None. ``verb`` is the word for what enter does."""

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
        with self.box(to_ascii(self._title, self._glyphs), f"enter: {self._verb}   esc: close"):
            yield Static(to_ascii(self._question, self._glyphs), markup=False)

    def action_confirm(self) -> None:
        """Answer yes."""
        self.dismiss(True)


class QuitQuestion(Confirm):
    """What ctrl+c asks; the app ends at a second one."""

    def __init__(self, glyphs: Glyphs) -> None:
        super().__init__("Quit?", "enter or ctrl+c: quit. esc: go on", "quit", glyphs)


# The model of the scenario


class ModelScreen(Dialog[None]):
    """⟨S, A, P, R, γ⟩, with the outcomes of the pair under the table's cursor, live while it is open."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("q", "cancel", "back", id="close_model", tooltip="Close the model."),
        Binding("h", "hide", "answer", id="model.hide", tooltip="Hide or show the exact values."),
    ]

    def __init__(
        self,
        look: Look,
        snapshot: Snapshot,
        pair: int | None,
        *,
        on_scrolled: Callable[[], None],
        hide_answer: Callable[[], None],
    ) -> None:
        super().__init__()
        self._hide_answer = hide_answer
        self._on_scrolled = on_scrolled
        self._panel = ModelPanel(look, id="box")
        self._snapshot = snapshot
        self._pair = pair

    def compose(self) -> ComposeResult:
        """Yield the panel."""
        yield self._panel

    def on_mount(self) -> None:
        """Show what is known already."""
        self.show(self._snapshot)
        if self._pair is not None:
            self._panel.show_pair(self._pair)
        self._panel.focus()

    @property
    def pair(self) -> int | None:
        """The pair whose outcomes are shown."""
        return self._panel.pair

    def on_scrolled(self) -> None:
        """Tell the playground that another pair of a large world is shown."""
        self._on_scrolled()

    def action_hide(self) -> None:
        """Hide or show the exact answer, as on the playground."""
        self._hide_answer()

    def show(self, snapshot: Snapshot) -> None:
        """Draw the newest snapshot."""
        self._panel.show(snapshot)
