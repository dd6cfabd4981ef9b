"""A cursor in one panel shows in the others where it stands."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from textual.message import Message
from textual.widget import Widget

NOWHERE: Final = range(0)


@dataclass
class Pointed(Message):
    """The cursor of ``panel`` was moved to what ``pairs`` are: those of a state, or one by itself.

    They are empty where there is no cursor any more, or where it stands on no pair.
    """

    panel: Widget
    pairs: range


@dataclass
class Moved(Message):
    """A person brought another part or another layer into view in ``panel``, without a cursor."""

    panel: Widget
