"""The last step taken apart: the loop, the update, the backup, the return, and the history of a cell."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar, Final

from rich.segment import Segment
from textual.binding import BindingType
from textual.strip import Strip

from rl_tui.lab.last_step.story import StepStory, story_of
from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.tui.draw.pieces import KEPT_BLANK, Line, Piece, strips_of, wrapped
from rl_tui.tui.panels.last_step.last_step import nothing_yet
from rl_tui.tui.panels.last_step.words import words_of
from rl_tui.tui.panels.microscope.backup_tree import BACKUP_HEADING, backup_rows, backup_section
from rl_tui.tui.panels.microscope.cell_history import history_strips
from rl_tui.tui.panels.microscope.return_text import RETURN_HEADING, RETURN_ROWS, return_section
from rl_tui.tui.panels.microscope.section import MicroscopeSection, stacked
from rl_tui.tui.panels.microscope.step import STEP_HEADING, STEP_ROWS, step_section
from rl_tui.tui.panels.microscope.update import UPDATE_HEADING, update_rows, update_section
from rl_tui.tui.panels.model.bellman import means_key
from rl_tui.tui.panels.scrolled_panel import ScrolledPanel, scroll_bindings
from rl_tui.tui.panels.snapshot_facts import passes_too_fast
from rl_tui.tui.theme.look import Look

ROOM_FOR_TWO: Final = 96
PASS_TOO_FAST: Final = "steps pass too fast"
TOO_FAST: Final = f"{PASS_TOO_FAST} to take one apart: space pauses, −{KEPT_BLANK}slows down"
_HISTORY_ROWS: Final = 7  # its heading, some rows of dots and the steps below them
_GAP: Final = 2


class Microscope(ScrolledPanel):
    """Sections below one another, in two columns where there is room; arrows and pgup, pgdn scroll them.

    ``pair`` is the one whose history is shown. Where steps pass too fast to be taken apart, only that history
    is drawn.
    """

    BINDINGS: ClassVar[list[BindingType]] = scroll_bindings("microscope")
    title = "Microscope"

    def __init__(self, look: Look, *, id: str | None = None, classes: str | None = None) -> None:  # noqa: A002
        super().__init__(look, id=id, classes=classes)
        self.pair: int | None = None

    @property
    def is_complete(self) -> bool:
        """Whether the newest snapshot has the history that is to be shown."""
        cell = None if self.snapshot is None else self.snapshot.cell
        return self.pair is None or (cell is not None and cell.pair == self.pair)

    def rows(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Return all rows of the page."""
        return page(snapshot, self.pair, self.look, width, height)

    def keys(self, snapshot: Snapshot | None) -> Sequence[str]:
        """Return the key that closes it."""
        return ("d: close",)


def lit_sources(snapshot: Snapshot) -> frozenset[int]:
    """Return the pairs that the table lights up as looked up; none where steps pass too fast to follow."""
    story = None if passes_too_fast(snapshot) else story_of(snapshot)
    return frozenset() if story is None else frozenset(story.sources)


def page(snapshot: Snapshot | None, pair: int | None, look: Look, width: int, height: int) -> list[Strip]:
    """Return all rows of the microscope, at least ``height`` where the history may grow.

    ``pair`` is the one whose history is shown.
    """
    columns = 2 if width >= ROOM_FOR_TWO else 1
    room = (width - _GAP * (columns - 1)) // columns
    story = None if snapshot is None else story_of(snapshot)
    if snapshot is None or story is None:
        nothing: list[Line] = [[Piece(f" {nothing_yet(snapshot)}", look.palette.dim)]]
        return strips_of(nothing, width, 1, look)
    sections = _sections(snapshot, story, look, room, secret=means_key(snapshot))
    parts = (sections,) if columns == 1 else (sections[:2] + sections[3:], sections[2:3])
    least = _HISTORY_ROWS if columns == 1 else _HISTORY_ROWS - 1
    sides = [
        stacked(part, look, room, height - below)
        for part, below in zip(parts, (0, least + 1)[-columns:], strict=True)
    ]
    left = max(least, height - len(sides[-1]))
    sides[-1] = [*sides[-1], *history_strips(snapshot, pair, look, room, left)]
    return sides[0] if columns == 1 else _beside(sides[0], sides[1], room, width, look)


def _sections(
    snapshot: Snapshot, story: StepStory, look: Look, width: int, *, secret: Sequence[str]
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
