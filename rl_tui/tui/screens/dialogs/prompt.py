"""Asks for one value and says at once what is wrong with it."""

from __future__ import annotations

from collections.abc import Callable

from textual.app import ComposeResult
from textual.widgets import Input, Static

from rl_tui.tui.screens.dialogs.dialog import Dialog

Reader = Callable[[str], float | str]
"""Turns the typed text into the value; raises ValueError whose text says what was expected."""


_LONGEST = 1_000  # characters: a pasted book is cut off


class Prompt(Dialog[float | str]):
    """One line to type a value into. Answers the value that ``read`` makes of it; escape answers None.

    ``does`` is what enter does with it, in a word.
    """

    def __init__(self, title: str, hint: str, value: str, read: Reader, does: str = "set") -> None:
        super().__init__()
        self._title = title
        self.typed = value
        """What stands in the line."""
        self.hint = hint
        self.value = value
        self.read = read
        self._does = does

    def compose(self) -> ComposeResult:
        """Yield the line, the sentence about it, and room for a fault."""
        with self.box(self._title, f"enter: {self._does}   esc: close"):
            yield Input(self.value, select_on_focus=True, compact=True, max_length=_LONGEST)
            yield Static(self.hint, classes="hint", markup=False)
            yield Static("", classes="error", markup=False)

    def on_input_changed(self, event: Input.Changed) -> None:
        """Show what is wrong while it is typed."""
        self.query_one(".error", Static).update(self._fault(event.value))

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Answer the value if it is one."""
        self.typed = event.value
        if not self._fault(event.value):
            self.dismiss(self.read(event.value))

    def _fault(self, text: str) -> str:
        try:
            self.read(text)
        except ValueError as fault:
            return str(fault)
        return ""
