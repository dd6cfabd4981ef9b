"""What the screen should show, and what was sent to the terminal last."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import compress, count
from operator import is_not, ne, or_
from unicodedata import category

from rich.cells import split_graphemes
from rich.segment import Segment

from rl_tui.screen.terminal.pens import Pen, Pens

UNKNOWN = "\0"  # it is not known what stands in such a cell


class Cutter:
    """Cuts texts into cells, as they were counted when the screen was laid out.

    A cell is one character with what combines with it; of a wide one, the second cell is the empty text.
    """

    def __init__(self) -> None:
        self.narrow = {chr(code) for code in range(0x20, 0x7F)}
        """Characters known to fill one cell, as every terminal has it."""

    def cells(self, text: str) -> list[str]:
        """Return the cells of ``text``, a sequence as long as the text is wide.

        Control characters have no width, and would steer the terminal: they are left out.
        """
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
    """The cells of one line: what stands in them, and the pen of each."""

    __slots__ = ("cells", "pens")

    def __init__(self, width: int, pen: Pen) -> None:
        self.cells = [UNKNOWN] * width
        self.pens = [pen] * width

    def copy_from(self, other: Line) -> None:
        """Become like ``other``."""
        self.cells[:] = other.cells
        self.pens[:] = other.pens


class ScreenBuffer:
    """Gathers what is drawn, until it is sent to the terminal.

    Cells that were not drawn yet are unknown, and are not sent.
    """

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
        """Lines of the screen."""
        return len(self._wanted)

    @property
    def is_touched(self) -> bool:
        """Whether something was drawn since it was sent last; it may be what stood there before."""
        return bool(self._touched)

    def resize(self, width: int, height: int) -> None:
        """Begin with an empty screen of ``width`` × ``height``, of which nothing is known."""
        self.width = width
        self._wanted = [Line(width, self._pens.plain) for _ in range(height)]
        self.forget()

    def forget(self) -> None:
        """Take what the terminal shows for unknown: all that is wanted has to be sent again."""
        self._sent = [Line(self.width, self._pens.plain) for _ in self._wanted]
        self._touched = set(range(len(self._wanted)))

    def put(self, x: int, y: int, segments: Iterable[Segment]) -> None:
        """Draw ``segments`` from column ``x`` of line ``y`` on; what lies outside is cut off."""
        if not 0 <= y < len(self._wanted) or not 0 <= x < self.width:
            return
        line = self._wanted[y]
        if line.cells[x] == "":  # the second half of a wide character, whose first stays alone
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
        """Yield each line that differs from what was sent: its number, itself, and its columns that differ.

        With each that has been asked for, the line counts as sent. If not all were, the next time begins with
        those that are left.
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
    # what differs in any way is found without a loop of our own: in most lines that is little
    differ = map(or_, map(ne, cells, old), map(is_not, pens, before))
    columns = [
        x
        for x in compress(count(), differ)
        if (cells[x] != old[x] or cells[x] != " " or pens[x].blank is not before[x].blank)
        and cells[x] != UNKNOWN
    ]
    if any(cells[x] == "" for x in columns):  # of a wide character both halves are written, or none
        return sorted({x - 1 if cells[x] == "" else x for x in columns})
    return columns
