"""What a watched program wrote: its last lines, each with the step, and at the end what it raised."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import ClassVar, Final

from textual.binding import BindingType
from textual.strip import Strip

from rl_tui.common.findings import one_line
from rl_tui.live.program_view import ProgramView
from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.draw.canvas import Line, Piece, strips_of
from rl_tui.screen.kit.scrolling import ScrolledPanel, scroll_bindings
from rl_tui.screen.panels.program.source import broken, in_characters, safe_line, source_lines
from rl_tui.screen.panels.program.words import LONGEST_NAME, LONGEST_SENTENCE, is_own, place_text
from rl_tui.screen.theme.look import Look

NOTHING_WRITTEN: Final = "your program has written nothing yet"
MOST_LINES: Final = 400
"""Lines of output that can be scrolled to."""

_MOST_ROWS: Final = 6  # of one line that is broken
_MOST_TRACEBACK: Final = 60  # lines
_LEAST_COLUMNS: Final = 10
_MOST_KEPT: Final = 2_048  # the same lines are drawn in every frame
_STDERR: Final = "!"


class OutputPanel(ScrolledPanel):
    """The lines below one another; the last one stays in view, unless a person has scrolled up."""

    BINDINGS: ClassVar[list[BindingType]] = scroll_bindings("output")
    title = "Output"

    def __init__(self, look: Look, *, id: str | None = None, classes: str | None = None) -> None:  # noqa: A002
        super().__init__(look, id=id, classes=classes)
        self._follows = True

    def rows(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Return all rows of the page, the oldest line first."""
        program = None if snapshot is None else snapshot.program
        if program is None:
            return []
        shown = program.output[-MOST_LINES:]
        columns = len(f"{shown[-1].step:,}") if shown else 0
        rows = [
            row
            for line in shown
            for row in _line_rows(line.step, line.stream, line.text, columns, width, self.look)
        ]
        ending = _ending(program, self.look, width)
        if not rows and not ending:
            ending = [[Piece(f" {NOTHING_WRITTEN}", self.look.palette.dim)]]
        rows += strips_of(ending, width, len(ending), self.look)
        if self._follows:
            self._first = max(0, len(rows) - height)
        return rows

    def keys(self, snapshot: Snapshot | None) -> Sequence[str]:
        """Return the key that closes it."""
        return ("O: close",)

    def _scroll(self, rows: int) -> None:
        self._follows = False
        super()._scroll(rows)
        self._follows = self._first >= self._rows_in_all - self.size.height


@lru_cache(_MOST_KEPT)
def _line_rows(step: int, stream: str, text: str, columns: int, width: int, look: Look) -> tuple[Strip, ...]:
    """Return a line behind the number of its step, in as many rows as it takes, up to some."""
    palette = look.palette
    is_error = stream == "err"
    mark = _STDERR if is_error else look.glyphs.axis_vertical
    style = palette.bad if is_error else palette.text
    room = max(_LEAST_COLUMNS, width - columns - 4)
    lines: list[Line] = []
    for place, part in enumerate(broken(in_characters(safe_line(text), look), room, _MOST_ROWS)):
        number = f"{step:,}" if place == 0 else ""
        head = [
            Piece(f" {number:>{columns}} ", palette.dim),
            Piece(f"{mark} ", style if is_error else palette.dim),
        ]
        lines.append([*head, Piece(part, style)])
    return tuple(strips_of(lines, width, len(lines), look))


def _ending(program: ProgramView, look: Look, width: int) -> list[Line]:
    """Return what the program raised, with its traceback and the line, or that it is over."""
    palette, error = look.palette, program.error
    if error is None:
        text = f" {look.glyphs.stopped} your program has ended"
        return [[Piece(text, palette.strong)]] if program.ended else []
    lines: list[Line] = []
    room = max(_LEAST_COLUMNS, width - 1)
    for text in _calls(error.traceback):
        parts = broken(in_characters(safe_line(text), look), room, _MOST_ROWS)
        lines += [[Piece(f" {part}", palette.dim)] for part in parts]
    place = place_text(error.file, error.line, program)
    what = f"{one_line(error.type, LONGEST_NAME)}: {one_line(error.text, LONGEST_SENTENCE)}"
    said = f"{look.glyphs.stopped} {what} ({place})" if place else f"{look.glyphs.stopped} {what}"
    lines += [
        [Piece(f" {part}", palette.bad)] for part in broken(in_characters(said, look), room, _MOST_ROWS)
    ]
    if error.line is not None and is_own(error.file, program):
        lines += source_lines(program.source, error.line, look, width)
    return lines


def _calls(traceback: str) -> Sequence[str]:
    """Return the last lines of ``traceback`` without the exception itself, which is not indented."""
    lines = traceback.splitlines()[-_MOST_TRACEBACK:]
    return lines[:-1] if lines and not lines[-1].startswith(" ") else lines
