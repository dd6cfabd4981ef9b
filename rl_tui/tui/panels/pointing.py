"""A cursor in one panel shows in the others where it stands."""

from __future__ import annotations

from typing import Final

from textual.message import Message
from textual.widget import Widget

NOWHERE: Final = range(0)


class Pointed(Message):
    """The cursor of ``panel`` was moved to what ``pairs`` are: those of a state, or one by itself.

    They are empty where there is no cursor any more, or where it stands on no pair.
    """

    def __init__(self, panel: Widget, pairs: range) -> None:
        super().__init__()
        self.panel = panel
        self.pairs = pairs
