"""The screen's contents, wanted and last sent."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import compress, count
from operator import is_not, ne, or_
from unicodedata import category

from rich.cells import split_graphemes
from rich.segment import Segment

from rl_tui.screen.terminal.pens import Pen, Pens

UNKNOWN = "\0"  # contents of a cell that are not known


class Cutter:
    """Cuts texts into cells: a character with its combining ones, then "" if it is wide."""

    def __init__(self) -> None:
        self.narrow = {chr(code) for code in range(0x20, 0x7F)}
        """Characters that are known to fill one cell in every terminal."""

    def cells(self, text: str) -> list[str]:
        """Return the cells, without control characters, which would control the terminal."""
        cells: list[str] = []
        text = "".join(character for character in text if category(character) != "Cc")
        for start, end, width in split_graphemes(text)[0]:
            cell = text[start:end]
            if width == 0:
                continue
            if width == 1 and len(cell) == 1:
                self.narrow.add(cell)
            cells.append(cell)
            cells.extend([""] * (width - 1))
        return cells


class Line:
    """The characters and pens of one line."""

    __slots__ = ("cells", "pens")

    def __init__(self, width: int, pen: Pen) -> None:
        self.cells = [UNKNOWN] * width
        self.pens = [pen] * width

    def copy_from(self, other: Line) -> None:
        """Copy another line's cells."""
        self.cells[:] = other.cells
        self.pens[:] = other.pens


class ScreenBuffer:
    """Drawing to be sent. Cells not drawn yet are unknown, and are not sent."""

    def __init__(self, pens: Pens, cutter: Cutter) -> None:
        self._pens = pens
        self._cutter = cutter
        self._touched: set[int] = set()
        self._first = range(0)
        self._next = 0
        self._wanted: list[Line] = []
        self._sent: list[Line] = []
        self.width = 0

    @property
    def height(self) -> int:
        """The number of lines."""
        return len(self._wanted)

    @property
    def is_touched(self) -> bool:
        """True if something was drawn since, even without a change."""
        return bool(self._touched)

    def resize(self, width: int, height: int) -> None:
        """Start empty, with unknown contents."""
        self.width = width
        self._wanted = [Line(width, self._pens.plain) for _ in range(height)]
        self.forget()

    def forget(self) -> None:
        """Treat the terminal's contents as unknown."""
        self._sent = [Line(self.width, self._pens.plain) for _ in self._wanted]
        self._touched = set(range(len(self._wanted)))

    def put(self, x: int, y: int, segments: Iterable[Segment]) -> None:
        """Draw ``segments``, clipped at the edges."""
        if not 0 <= y < len(self._wanted) or not 0 <= x < self.width:
            return
        line = self._wanted[y]
        if line.cells[x] == "":  # half of a wide character is overwritten
            line.cells[x - 1] = " "
        pen_of, cells_of, width = self._pens.of, self._cutter.cells, self.width
        is_narrow = self._cutter.narrow.issuperset
        all_cells, all_pens = line.cells, line.pens
        for text, style, control in segments:
            if control:
                continue
            pen = pen_of(style)
            cells: Sequence[str] = text if is_narrow(text) else cells_of(text)
            end = x + len(cells)
            if end > width:
                room, end = width - x, width
                half = room > 0 and cells[room] == ""  # of a wide character
                cells = [*cells[: room - half], *" "[:half]]
            all_cells[x:end] = cells
            all_pens[x:end] = [pen] * (end - x)
            x = end
        if x < self.width and line.cells[x] == "":
            line.cells[x] = " "
        self._touched.add(y)

    def begin_with(self, lines: range) -> None:
        """Send ``lines`` before all others, once."""
        self._first = lines

    def changed(self) -> Iterator[tuple[int, Line, list[int]]]:
        """Yield each changed line: its number, the line, and its changed columns.

        A yielded line counts as sent. Lines not asked for come first next time.
        """
        from_here = sorted(self._touched, key=lambda y: (y not in self._first, y < self._next, y))
        for y in from_here:
            if y not in self._first:
                self._first = range(0)
            self._next = y + 1
            self._touched.discard(y)
            wanted, sent = self._wanted[y], self._sent[y]
            if wanted.cells == sent.cells and wanted.pens == sent.pens:
                continue
            columns = _columns(wanted, sent)
            sent.copy_from(wanted)
            if columns:
                yield y, wanted, columns
        self._first, self._next = range(0), 0


def _columns(wanted: Line, sent: Line) -> list[int]:
    cells, old, pens, before = wanted.cells, sent.cells, wanted.pens, sent.pens
    # a fast search without a Python loop, because few columns of a line change
    differ = map(or_, map(ne, cells, old), map(is_not, pens, before))
    columns = [
        x
        for x in compress(count(), differ)
        if (cells[x] != old[x] or cells[x] != " " or pens[x].blank is not before[x].blank)
        and cells[x] != UNKNOWN
    ]
    if any(cells[x] == "" for x in columns):  # both halves of a wide character are written, or none
        return sorted({x - 1 if cells[x] == "" else x for x in columns})
    return columns
