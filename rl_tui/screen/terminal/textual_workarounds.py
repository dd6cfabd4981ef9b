"""Where Textual needs help from outside."""

from __future__ import annotations

from contextlib import suppress


def forget_left_screens(_: object) -> None:
    """Forget the lines of widgets that are gone; to be called whenever another screen is in front.

    A cache of colours has the lines of whole widgets in its keys, 1,024 of them, so that each dialog that
    was opened took a third of a megabyte with it (Textualize/textual #6665).
    """
    with suppress(ImportError, AttributeError):  # another Textual may keep no such lines
        from textual._styles_cache import StylesCache

        StylesCache.get_inner_outer.cache_clear()
