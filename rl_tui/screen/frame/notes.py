"""A scenario's notes, Markdown."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rl_tui.screen.draw.to_ascii import to_ascii
from rl_tui.screen.theme.glyphs import Glyphs

if TYPE_CHECKING:
    from textual.widgets import Markdown

_ASCII_BULLETS = ["* "]


def notes_markdown(markdown: str, glyphs: Glyphs) -> Markdown:
    """Return the widget that draws ``markdown`` in the characters of ``glyphs``; the app shows addresses."""
    from textual.widgets import Markdown  # its parser is slow to load and must not delay the first paint

    widget = Markdown(to_ascii(markdown, glyphs), open_links=True)
    if glyphs.name == "ascii":
        widget.BULLETS = _ASCII_BULLETS
    return widget
