"""The last step taken apart: the loop, the update, the backup, the return, and the history of a cell."""

from __future__ import annotations

from typing import ClassVar, Final

from rich.segment import Segment
from textual import events
from textual.binding import BindingType
from textual.strip import Strip

from rl_tui.lab.last_step.story import StepStory, story_of
from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.tui.draw.canvas import Canvas
from rl_tui.tui.draw.pieces import KEPT_BLANK, Line, Piece, strips_of, wrapped
from rl_tui.tui.panels.bindings import binding
from rl_tui.tui.panels.last_step.last_step import nothing_yet
from rl_tui.tui.panels.last_step.words import words_of
from rl_tui.tui.panels.microscope.backup_tree import BACKUP_HEADING, backup_rows, backup_section
from rl_tui.tui.panels.microscope.cell_history import history_strips
from rl_tui.tui.panels.microscope.return_text import RETURN_HEADING, RETURN_ROWS, return_section
from rl_tui.tui.panels.microscope.section import MicroscopeSection, stacked
from rl_tui.tui.panels.microscope.step import STEP_HEADING, STEP_ROWS, step_section
from rl_tui.tui.panels.microscope.update import UPDATE_HEADING, update_rows, update_section
from rl_tui.tui.panels.panel import Panel
from rl_tui.tui.panels.snapshot_facts import is_secret, passes_too_fast
from rl_tui.tui.theme.look import Look

_WHEEL_ROWS: Final = 3
ROOM_FOR_TWO: Final = 96
TOO_FAST: Final = f"steps pass too fast to take one apart: space pauses, −{KEPT_BLANK}slows down"
_HISTORY_ROWS: Final = 7  # its heading, some rows of dots and the steps below them
_GAP: Final = 2


class Microscope(Panel, can_focus=True):
    """Sections below one another, in two columns where there is room; arrows and pgup, pgdn scroll them.

    ``pair`` is the one whose history is shown. Where steps pass too fast to be taken apart, only that history
    is drawn.
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        binding("up", "scroll_rows(-1)", "microscope.up", "Scroll up"),
        binding("down", "scroll_rows(1)", "microscope.down", "Scroll down"),
        binding("pageup", "scroll_pages(-1)", "microscope.page_up", "A page up"),
        binding("pagedown", "scroll_pages(1)", "microscope.page_down", "A page down"),
        binding("home", "scroll_rows(-999)", "microscope.first", "To the top"),
        binding("end", "scroll_rows(999)", "microscope.last", "To the end"),
    ]

    def __init__(self, look: Look, *, id: str | None = None, classes: str | None = None) -> None:  # noqa: A002
        super().__init__(look, id=id, classes=classes)
        self.pair: int | None = None
        self.heading = "Microscope"
        self._first = 0
        self._rows_in_all = 0
        self._has_bar = False

    @property
    def is_complete(self) -> bool:
        """Whether the newest snapshot has the history that is to be shown."""
        cell = None if self.snapshot is None else self.snapshot.cell
        return self.pair is None or (cell is not None and cell.pair == self.pair)

    def picture(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Return the rows in view, with a bar at the right where there are more."""
        rows, is_scrolled = self._page(snapshot, width, height)
        self.heading = self.fitting((*self.captioned("Microscope"), "Microscope"), width)
        self._rows_in_all = len(rows)
        self._first = max(0, min(self._first, len(rows) - height))
        shown = rows[self._first : self._first + height]
        self.footing = self.fitting(_keys(is_scrolled=is_scrolled), width)
        shown += [Strip.blank(width, self.look.palette.text)] * (height - len(shown))
        if not is_scrolled:
            return shown
        bar = _scroll_bar(self._first, height, len(rows), self.look)
        return [Strip([*row, *end], width) for row, end in zip(shown, bar, strict=True)]

    def _page(self, snapshot: Snapshot | None, width: int, height: int) -> tuple[list[Strip], bool]:
        """Return all rows, and whether they need a bar beside them; mostly as it was the last time."""
        for has_bar in (self._has_bar, not self._has_bar):
            room = width - 1 if has_bar else width
            rows = page(snapshot, self.pair, self.look, room, height, revealed=self.tells_all)
            self._has_bar = len(rows) > height
            if self._has_bar is has_bar:
                break
        return rows, has_bar

    def action_scroll_rows(self, rows: int) -> None:
        """Scroll by so many rows."""
        self._scroll(rows)

    def action_scroll_pages(self, pages: int) -> None:
        """Scroll by so many pages, a row less each, so that nothing is skipped."""
        self._scroll(pages * max(1, self.size.height - 1))

    def on_mouse_scroll_down(self, event: events.MouseScrollDown) -> None:
        """Scroll down by a few rows."""
        event.stop()
        self._scroll(_WHEEL_ROWS)

    def on_mouse_scroll_up(self, event: events.MouseScrollUp) -> None:
        """Scroll up by a few rows."""
        event.stop()
        self._scroll(-_WHEEL_ROWS)

    def _scroll(self, rows: int) -> None:
        self._first = max(0, min(self._first + rows, self._rows_in_all - self.size.height))
        self.redraw()


def lit_sources(snapshot: Snapshot) -> frozenset[int]:
    """Return the pairs that the table lights up as looked up; none where steps pass too fast to follow."""
    story = None if passes_too_fast(snapshot) else story_of(snapshot)
    return frozenset() if story is None else frozenset(story.sources)


def _scroll_bar(first: int, height: int, rows: int, look: Look) -> list[Strip]:
    canvas, glyphs = Canvas(1, height, look.palette.dim), look.glyphs
    length = max(1, height * height // rows)
    start = round((height - length) * first / max(1, rows - height))
    for y in range(height):
        inside = start <= y < start + length
        canvas.put(0, y, glyphs.bar if inside else glyphs.axis_vertical, look.palette.dim)
    return canvas.strips()


def _keys(*, is_scrolled: bool) -> list[str]:
    """Return the keys of the panel, longest form first."""
    close = "d: close"
    if not is_scrolled:
        return [close]
    return [f"↑ ↓ pgup pgdn: more · {close}", f"↑ ↓: more · {close}", close]


def page(
    snapshot: Snapshot | None, pair: int | None, look: Look, width: int, height: int, *, revealed: bool
) -> list[Strip]:
    """Return all rows of the microscope, at least ``height`` where the history may grow.

    ``pair`` is the one whose history is shown; ``revealed`` says that a bandit's means are shown.
    """
    columns = 2 if width >= ROOM_FOR_TWO else 1
    room = (width - _GAP * (columns - 1)) // columns
    story = None if snapshot is None else story_of(snapshot)
    if snapshot is None or story is None:
        nothing: list[Line] = [[Piece(f" {nothing_yet(snapshot)}", look.palette.dim)]]
        return strips_of(nothing, width, 1, look)
    sections = _sections(snapshot, story, look, room, secret=is_secret(snapshot, revealed=revealed))
    parts = (sections,) if columns == 1 else (sections[:2] + sections[3:], sections[2:3])
    least = _HISTORY_ROWS if columns == 1 else _HISTORY_ROWS - 1
    sides = [
        stacked(part, look, room, height - below)
        for part, below in zip(parts, (0, least + 1)[-columns:], strict=True)
    ]
    left = max(least, height - len(sides[-1]))
    sides[-1] = [*sides[-1], *history_strips(snapshot, pair, look, room, left, revealed=revealed)]
    return sides[0] if columns == 1 else _beside(sides[0], sides[1], room, width, look)


def _sections(
    snapshot: Snapshot, story: StepStory, look: Look, width: int, *, secret: bool
) -> list[MicroscopeSection]:
    """Return the step, the update, the backup and the return."""
    if passes_too_fast(snapshot):
        return _calm(story, look, width)
    words = words_of(story, look.glyphs)
    return [
        step_section(words, look, width),
        update_section(words, look, width),
        backup_section(words, look, width, secret=secret),
        return_section(story, look, width),
    ]


def _calm(story: StepStory, look: Look, width: int) -> list[MicroscopeSection]:
    """Return the headings with nothing below them that changes from frame to frame."""
    return [
        MicroscopeSection(
            STEP_HEADING,
            wrapped(TOO_FAST, width, look.palette.dim, look, " ", " "),
            STEP_ROWS,
        ),
        MicroscopeSection(UPDATE_HEADING, [], update_rows(story.terms)),
        MicroscopeSection(BACKUP_HEADING, [], backup_rows(story.world)),
        MicroscopeSection(RETURN_HEADING, [], RETURN_ROWS),
    ]


def _beside(left: list[Strip], right: list[Strip], room: int, width: int, look: Look) -> list[Strip]:
    """Return two columns of ``room`` cells side by side, as long as the longer one."""
    text = look.palette.text
    rows = max(len(left), len(right))
    blank = Strip.blank(room, text)
    padded = ([*side, *([blank] * (rows - len(side)))] for side in (left, right))
    gap = Segment(" " * (width - 2 * room), text)
    return [Strip([*one, gap, *other], width) for one, other in zip(*padded, strict=True)]
