"""The keys of a panel."""

from __future__ import annotations

from typing import Final

from textual.binding import Binding

_NAMES: Final = {
    "esc": "escape",
    "space": "space",
    "enter": "enter",
    "tab": "tab",
    "?": "question_mark",
    "↑": "up",
    "↓": "down",
    "←": "left",
    "→": "right",
}


def binding(keys: str, action: str, id: str, tooltip: str) -> Binding:  # noqa: A002
    """Return a binding that no footer shows; ``id`` is panel.name, and what Textual calls it is that name.

    What ``up`` and ``down`` do, ``k`` and ``j`` do as well.
    """
    for key, letter in (("up", "k"), ("down", "j")):
        keys = ",".join((*keys.split(","), letter)) if key in keys.split(",") else keys
    name = id.partition(".")[2].replace("_", " ").capitalize()
    return Binding(keys, action, name, show=False, id=id, tooltip=tooltip)


def key_of_hint(written: str) -> str | None:
    """Return the key that a hint writes as ``esc`` or ``v``; None where that is no one key."""
    return _NAMES.get(written, written if len(written) == 1 else None)
