"""What the screen should show, and what the terminal was told last."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from rich.segment import Segment

from rl_tui.tui.terminal.cells import UNKNOWN, Cutter
from rl_tui.tui.terminal.pens import Pen, Pens


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
    """Gathers what is drawn, until it is told to the terminal.

    Cells that nobody has drawn yet are unknown, and nothing is told of them.
    """

    def __init__(self, pens: Pens, cutter: Cutter) -> None:
        self._pens = pens
        self._cutter = cutter
        self._touched: set[int] = set()
        self._next = 0
        self._wanted: list[Line] = []
        self._told: list[Line] = []
        self.width = 0

    @property
    def height(self) -> int:
        """Lines of the screen."""
        return len(self._wanted)

    @property
    def is_touched(self) -> bool:
        """Whether something was drawn since it was told last; it may be what stood there before."""
        return bool(self._touched)

    def resize(self, width: int, height: int) -> None:
        """Begin with an empty screen of ``width`` × ``height``, of which nothing is known."""
        self.width = width
        self._wanted = [Line(width, self._pens.plain) for _ in range(height)]
        self.forget()

    def forget(self) -> None:
        """Take what the terminal shows for unknown: all that is wanted has to be told again."""
        self._told = [Line(self.width, self._pens.plain) for _ in self._wanted]
        self._touched = set(range(len(self._wanted)))

    def put(self, x: int, y: int, segments: Iterable[Segment]) -> None:
        """Draw ``segments`` from column ``x`` of line ``y`` on; what lies outside is cut off."""
        if not 0 <= y < len(self._wanted) or not 0 <= x < self.width:
            return
        line = self._wanted[y]
        if line.cells[x] == "":  # the second half of a wide character, whose first stays alone
            line.cells[x - 1] = " "
        pen_of, cells_of = self._pens.of, self._cutter.cells
        for text, style, control in segments:
            if control:
                continue
            pen = pen_of(style)
            if text.isspace():
                pen = pen.blank
            cells: Sequence[str] = cells_of(text)
            count = len(cells)
            if x + count > self.width:
                room = self.width - x
                half = room > 0 and cells[room] == ""  # of a wide character
                cells, count = [*cells[: room - half], *" "[:half]], room
            line.cells[x : x + count] = cells
            line.pens[x : x + count] = [pen] * count
            x += count
        if x < self.width and line.cells[x] == "":
            line.cells[x] = " "
        self._touched.add(y)

    def changed(self) -> Iterator[tuple[int, Line, list[int]]]:
        """Yield each line that differs from what was told: its number, itself, and its columns that differ.

        With each that has been asked for, the line counts as told. If not all were, the next time begins with
        those that are left.
        """
        from_here = sorted(self._touched, key=lambda y: (y < self._next, y))
        for y in from_here:
            self._next = y + 1
            self._touched.discard(y)
            wanted, told = self._wanted[y], self._told[y]
            if wanted.cells == told.cells and wanted.pens == told.pens:
                continue
            columns = _columns(wanted, told)
            told.copy_from(wanted)
            if columns:
                yield y, wanted, columns
        self._next = 0


def _columns(wanted: Line, told: Line) -> list[int]:
    columns = [
        x
        for x, (cell, old, pen, before) in enumerate(
            zip(wanted.cells, told.cells, wanted.pens, told.pens, strict=True)
        )
        if (cell != old or (pen is not before and (cell != " " or pen.blank is not before.blank)))
        and cell != UNKNOWN
    ]
    if any(wanted.cells[x] == "" for x in columns):  # of a wide character both halves are written, or none
        return sorted({x - 1 if wanted.cells[x] == "" else x for x in columns})
    return columns
