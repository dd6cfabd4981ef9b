"""Scrolling panels."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import ClassVar, Final

from rich.segment import Segment
from textual import events
from textual.binding import BindingType
from textual.message import Message
from textual.strip import Strip

from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.draw.canvas import Line, strips_of
from rl_tui.screen.kit.bindings import binding
from rl_tui.screen.kit.blocks import Block, lines_of
from rl_tui.screen.kit.panel import Panel
from rl_tui.screen.theme.look import Look

# The visible part


class Scrolled(Message):
    """The next snapshot needs another part of a large world."""


def kept_in_view(first: int, place: int | None, shown: int, total: int) -> int:
    """Return the first visible line such that ``place`` is visible.

    It stays ``first`` unless ``place`` is too near to an edge. Then the view centres on it.
    """
    if place is not None:
        margin = 1 if shown > 2 else 0
        if not first + margin <= place < first + shown - margin:
            first = place - shown // 2
    return max(0, min(first, total - shown))


def scrolled_to(first: int, place: int, shown: int) -> int:
    """Return the nearest line that shows ``place``."""
    return max(place - shown + 1, min(first, place))


def scroll_bar(first: int, shown: int, total: int, height: int, look: Look) -> list[Segment]:
    """Draw a scroll bar of ``height`` cells."""
    length = max(1, height * shown // total)
    start = round((height - length) * first / max(1, total - shown))
    dim, glyphs = look.palette.dim, look.glyphs
    signs = (start <= y < start + length for y in range(height))
    return [Segment(glyphs.bar if inside else glyphs.axis_vertical, dim) for inside in signs]


# A panel of rows


_MOST_LEFT_OUT: Final = 2


def scroll_bindings(panel: str) -> list[BindingType]:
    """Return a panel's scroll keys."""
    return [
        binding("up", "scroll_rows(-1)", f"{panel}.up", "Scroll up"),
        binding("down", "scroll_rows(1)", f"{panel}.down", "Scroll down"),
        *page_bindings(panel),
    ]


def page_bindings(panel: str) -> list[BindingType]:
    """Return scroll keys for cursors, without up and down."""
    return [
        binding("pageup", "scroll_pages(-1)", f"{panel}.page_up", "A page up"),
        binding("pagedown", "scroll_pages(1)", f"{panel}.page_down", "A page down"),
        binding("home", "scroll_rows(-999)", f"{panel}.first", "To the top"),
        binding("end", "scroll_rows(999)", f"{panel}.last", "To the end"),
    ]


_CLOSE: Final = "esc: close"
_TAB: Final = f"tab here for its keys · {_CLOSE}"
_ELSEWHERE: Final = (f"click or {_TAB}", _TAB, _CLOSE)
"""Forms of the hint while another panel has the keys."""


class ScrolledPanel(Panel, can_focus=True):
    """A panel that scrolls its rows, with a bar at the right.

    Subclasses set ``title``, implement :meth:`blocks` or :meth:`rows`, and override :meth:`keys` or
    :meth:`hints` for their own keys.
    """

    title: ClassVar[str]
    _first = _rows_in_all = _rows_wanted = _rows_in_view = 0
    _has_bar = False

    def rows(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Return all rows of ``width`` cells."""
        lines: list[Line] = []
        for left_out in range(_MOST_LEFT_OUT + 1):
            lines = lines_of(self.blocks(snapshot, left_out), width, self.look)
            if left_out == 0:
                self._rows_wanted = len(lines)
            blanks = [place for place, line in enumerate(lines) if not line]
            # those at the ends first: the others part the lines of a table
            surplus = [*blanks[-1:], *blanks[:-1]][: max(0, len(lines) - height)]
            if len(lines) - len(surplus) <= height:
                lines = [line for place, line in enumerate(lines) if place not in surplus]
            if len(lines) <= height:
                break
        self.free_rows = max(0, height - len(lines))
        return strips_of(lines, width, len(lines), self.look)

    def blocks(self, snapshot: Snapshot | None, left_out: int) -> Iterable[Block]:
        """Return the contents. ``left_out`` (0 to 2) omits more and more."""
        raise NotImplementedError

    def keys(self, snapshot: Snapshot | None) -> Sequence[str]:
        """Return forms of other keys."""
        return (_CLOSE,)

    def hints(self, snapshot: Snapshot | None, *, is_scrolled: bool) -> Sequence[str]:
        """Return forms of all keys, for a panel with focus."""
        keys = self.keys(snapshot)
        if not is_scrolled:
            return keys
        return f"↑ ↓ pgup pgdn: more · {keys[0]}", *(f"↑ ↓: more · {form}" for form in keys), *keys

    def picture(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Draw the visible rows."""
        self.heading = self.fitting((*self.captioned(self.title), self.title), width)
        rows, is_scrolled = self._fitted(snapshot, width, height)
        self._rows_in_all, self._rows_in_view = len(rows), height
        self._first = max(0, min(self._first, len(rows) - height))
        shown = rows[self._first : self._first + height]
        hints = self.hints(snapshot, is_scrolled=is_scrolled)
        is_elsewhere = not self.has_focus and tuple(hints) != (_CLOSE,)
        self.footing = self.fitting(_ELSEWHERE if is_elsewhere else hints, width)
        shown += [Strip.blank(width, self.look.palette.text)] * (height - len(shown))
        if not is_scrolled:
            return shown
        bar = scroll_bar(self._first, height, len(rows), height, self.look)
        return [Strip([*row, end], width) for row, end in zip(shown, bar, strict=True)]

    def _fitted(self, snapshot: Snapshot | None, width: int, height: int) -> tuple[list[Strip], bool]:
        for has_bar in (self._has_bar, not self._has_bar):
            rows = self.rows(snapshot, width - 1 if has_bar else width, height)
            self._has_bar = len(rows) > height
            if self._has_bar is has_bar:
                break
        return rows, has_bar

    def action_scroll_rows(self, rows: int) -> None:
        """Scroll by ``rows``."""
        self._scroll(rows)

    def action_scroll_pages(self, pages: int) -> None:
        """Scroll with one row of overlap."""
        self._scroll(pages * max(1, self._rows_in_view - 1))

    def turn_wheel(self, rows: int, event: events.MouseEvent) -> None:
        """Scroll by ``rows``."""
        event.stop()
        self._scroll(rows)

    def _scroll(self, rows: int) -> None:
        self._first = max(0, min(self._first + rows, self._rows_in_all - self._rows_in_view))
        self.redraw()
