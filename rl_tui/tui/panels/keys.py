"""The keys that a panel takes for itself while it is in focus."""

from __future__ import annotations

from textual.binding import Binding


def panel_key(panel: str, name: str, keys: str, action: str, tooltip: str) -> Binding:
    """Return a binding of ``panel`` that no line of hints lists; a keymap knows it as ``panel.name``."""
    label = name.replace("_", " ").capitalize()
    return Binding(keys, action, label, show=False, id=f"{panel}.{name}", tooltip=tooltip)
