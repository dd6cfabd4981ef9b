"""The keys of a panel."""

from __future__ import annotations

from textual.binding import Binding


def binding(keys: str, action: str, id: str, tooltip: str) -> Binding:  # noqa: A002
    """Return a binding that no footer shows; ``id`` is panel.name, and what Textual calls it is that name."""
    name = id.partition(".")[2].replace("_", " ").capitalize()
    return Binding(keys, action, name, show=False, id=id, tooltip=tooltip)
