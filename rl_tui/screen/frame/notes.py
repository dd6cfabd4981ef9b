"""A scenario's notes, Markdown."""

from __future__ import annotations

from typing import TYPE_CHECKING

from textual.containers import Vertical

from rl_tui.screen.draw.to_ascii import to_ascii
from rl_tui.screen.theme.glyphs import Glyphs

if TYPE_CHECKING:
    from textual.widgets import Markdown

_ASCII_BULLETS = ["* "]


class Notes(Vertical):
    """Draws Markdown in the characters of ``glyphs``."""

    def __init__(self, glyphs: Glyphs, *, id: str | None = None) -> None:  # noqa: A002
        super().__init__(id=id)
        self._glyphs = glyphs
        self._shown: str | None = None

    async def show(self, markdown: str) -> None:
        """Replace what is shown by ``markdown``; the same text again stays as it is."""
        if markdown == self._shown:
            return
        self._shown = None  # whoever cancels this leaves it unfinished
        await self.remove_children()
        if markdown and self.is_attached:  # the app may have ended meanwhile
            await self.mount(notes_markdown(markdown, self._glyphs))
        self._shown = markdown

    def hide(self) -> None:
        """Hide what is shown, at once; the same text again is drawn anew."""
        self._shown = None
        for child in self.children:
            child.display = False


def notes_markdown(markdown: str, glyphs: Glyphs) -> Markdown:
    """Return the widget that draws ``markdown`` in the characters of ``glyphs``; the app shows addresses."""
    from textual.widgets import Markdown  # its parser is slow to load and must not delay the first paint

    widget = Markdown(to_ascii(markdown, glyphs), open_links=True)
    if glyphs.name == "ascii":
        widget.BULLETS = _ASCII_BULLETS
    return widget
