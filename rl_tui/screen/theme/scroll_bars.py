"""Scroll bars in the characters that the terminal has."""

from __future__ import annotations

from typing import ClassVar

from textual.scrollbar import ScrollBar, ScrollBarRender


class PlainScrollBar(ScrollBarRender):
    """A bar of whole cells: its ends are drawn by the background alone."""

    VERTICAL_BARS: ClassVar[list[str]] = [" "] * len(ScrollBarRender.VERTICAL_BARS)
    HORIZONTAL_BARS: ClassVar[list[str]] = [" "] * len(ScrollBarRender.HORIZONTAL_BARS)


def use_scroll_bars(*, ascii_only: bool) -> None:
    """Let every scroll bar made from here on keep to ASCII, or not."""
    ScrollBar.renderer = PlainScrollBar if ascii_only else ScrollBarRender
