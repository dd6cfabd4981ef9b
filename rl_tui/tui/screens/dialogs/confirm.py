"""Asks before something is done that cannot be undone."""

from __future__ import annotations

from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.widgets import Static

from rl_tui.tui.draw.to_ascii import to_ascii
from rl_tui.tui.screens.dialogs.dialog import Dialog
from rl_tui.tui.theme.glyphs import Glyphs


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
        super().__init__("Quit?", "enter quits, and so does ctrl+c once more; esc goes on", "quit", glyphs)
