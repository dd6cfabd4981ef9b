"""Which part is in view of what does not fit."""

from __future__ import annotations

from textual.message import Message


class Scrolled(Message):
    """A panel shows another part of a large world than before: the next snapshot has to have it."""


def kept_in_view(first: int, place: int | None, shown: int, total: int) -> int:
    """Return the first of ``shown`` lines out of ``total``, near ``first``, that has ``place`` in view.

    It stays as it is while ``place`` (None: nothing to follow) is one line off the edge; otherwise ``place``
    comes to the middle.
    """
    if place is not None:
        margin = 1 if shown > 2 else 0
        if not first + margin <= place < first + shown - margin:
            first = place - shown // 2
    return max(0, min(first, total - shown))


def scrolled_to(first: int, place: int, shown: int) -> int:
    """Return the first of ``shown`` lines, as near to ``first`` as has ``place`` in view."""
    return max(place - shown + 1, min(first, place))
