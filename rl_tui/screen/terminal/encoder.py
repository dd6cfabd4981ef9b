"""Changed cells as the shortest text that makes a terminal show them.

Only what every terminal knows is used: to go to a line and column, to go right or to a column, colours and
attributes, and to erase the rest of a line. That erases with the background that is set in xterm, tmux and
the Linux console, and with the terminal's own in screen: it is used for the terminal's own only, where they
agree. Characters that repeat are written out, for the Linux console and screen do not know how to repeat
them.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable
from math import inf
from typing import Final, NamedTuple

from rl_tui.screen.terminal.pens import RESET, Pen, Pens
from rl_tui.screen.terminal.screen_buffer import Cutter, Line

_ERASE_REST: Final = "\x1b[K"
_PLENTY: Final = 16_000  # characters: to look for a shorter way takes longer than to send so many
_WORTH_ERASING: Final = 4  # so many blanks are longer than the sequence


def move_to(x: int, y: int) -> str:
    """Return the sequence that puts the cursor into column ``x`` of line ``y``, both counted from 0."""
    if x:
        return f"\x1b[{y + 1};{x + 1}H"
    return f"\x1b[{y + 1}H" if y else "\x1b[H"


class _Written(NamedTuple):
    """A text, the pen that is set after it, and where the cursor stands, −1 if that is not sure."""

    text: str
    pen: Pen
    at: int


class Encoder:
    """Writes changed lines for a terminal that does not wrap lines."""

    def __init__(self, pens: Pens, cutter: Cutter) -> None:
        self._pens = pens
        self._cutter = cutter

    def frame(self, changed: Iterable[tuple[int, Line, list[int]]], size: float = inf) -> str:
        """Return the text of a frame, empty if nothing has changed.

        With the line that makes it longer than ``size`` characters it is full, and asks no more. It begins
        and ends with the terminal's own colours, so that whatever is written between frames, or after the
        last, has them too.
        """
        lines: list[str] = []
        pen = self._pens.plain
        length = 0
        for y, line, columns in changed:
            text, pen = self._line(y, line, columns, pen, spares=size < _PLENTY)
            lines.append(text)
            length += len(text)
            if length > size:
                break
        if pen is not self._pens.plain:
            lines.append(RESET)
        return "".join(lines)

    def _line(self, y: int, line: Line, columns: list[int], pen: Pen, *, spares: bool) -> tuple[str, Pen]:
        """Return what tells ``columns`` of ``line``, and the pen that is set then.

        It ``spares`` characters by writing pen by pen, where that is shorter than from left to right.
        """
        erased = self._erased_from(line, columns)
        kept = columns[: bisect_left(columns, erased)]
        pens = _pens_of(line, kept, pen)
        cells = list(zip(kept, pens, strict=True))
        way = self._written(y, line, cells, pen)
        if spares:
            order = {each: number for number, each in enumerate(dict.fromkeys([pen, *pens]))}
            by_pen = self._written(y, line, sorted(cells, key=lambda cell: order[cell[1]]), pen)
            way = min(way, by_pen, key=lambda each: len(each.text))
        if len(kept) == len(columns):
            return way.text, way.pen
        move = "" if way.at == erased else move_to(erased, y)
        plain = self._pens.plain
        return f"{way.text}{move}{self._pens.change(way.pen, plain)}{_ERASE_REST}", plain

    def _written(self, y: int, line: Line, cells: Iterable[tuple[int, Pen]], pen: Pen) -> _Written:
        """Write ``cells`` of ``line``, columns and their pens, in this order; ``pen`` is set."""
        characters, change, narrow = line.cells, self._pens.change, self._cutter.narrow
        written: list[str] = []
        write = written.append
        last = len(characters) - 1
        at = -1
        for x, wanted in cells:
            if x != at:
                write(move_to(x, y) if at < 0 else self._way(at, x, line, pen))
            if wanted is not pen:
                write(change(pen, wanted))
                pen = wanted
            cell = characters[x]
            write(cell)
            # terminals disagree about the width of rare characters, and stay in the last column
            at = x + 1 if cell in narrow and x < last else -1
        return _Written("".join(written), pen, at)

    def _way(self, at: int, x: int, line: Line, pen: Pen) -> str:
        """Return the shortest way from column ``at`` to ``x``: writing again what stands between is one."""
        if x < at:
            return f"\x1b[{x + 1}G"
        step = f"\x1b[{x - at}C" if x - at > 1 else "\x1b[C"
        if x - at <= len(step):
            between = "".join(line.cells[at:x])
            if len(between.encode()) <= len(step) and self._cutter.narrow.issuperset(between):
                seen = zip(line.cells[at:x], line.pens[at:x], strict=True)
                if all(other is pen or (cell == " " and other.blank is pen.blank) for cell, other in seen):
                    return between
        return step

    def _erased_from(self, line: Line, columns: list[int]) -> int:
        """Return the column from which on the line is erased, its width if it is not."""
        plain, width = self._pens.plain, len(line.cells)
        start = width
        while start and line.cells[start - 1] == " " and line.pens[start - 1].blank is plain:
            start -= 1
        changed = len(columns) - bisect_left(columns, start)
        return start if changed > _WORTH_ERASING else width


def _pens_of(line: Line, columns: list[int], pen: Pen) -> list[Pen]:
    """Return the pen that writes each of ``columns`` after ``pen``: for a blank there is a choice."""
    pens = []
    for number, x in enumerate(columns):
        wanted = line.pens[x]
        if line.cells[x] != " ":
            pen = wanted
        elif wanted.blank is not pen.blank:
            pen = _pen_ahead(line, columns, number)
        pens.append(pen)
    return pens


def _pen_ahead(line: Line, columns: list[int], number: int) -> Pen:
    """Return the pen for a blank: that of the next character, if the blank looks the same with it."""
    blank = line.pens[columns[number]].blank
    x = columns[number]
    for other in columns[number:]:
        if other != x or line.pens[x].blank is not blank:
            break
        if line.cells[x] != " ":
            return line.pens[x]
        x += 1
    return blank
