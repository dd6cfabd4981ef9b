"""Encodes changed cells as the shortest text for the terminal.

Each pen is set once per frame, because moving the cursor is shorter than setting the pen again. Only
sequences that every terminal knows are used. Erasing a line uses only the terminal's own background, because
terminals disagree about others.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable, Iterator
from itertools import groupby
from math import inf
from typing import Final, NamedTuple

from rl_tui.screen.terminal.pens import RESET, Pen, Pens
from rl_tui.screen.terminal.screen_buffer import Cutter, Line

_ERASE_REST: Final = "\x1b[K"
_WORTH_ERASING: Final = 4  # more blanks are longer than the sequence
_JUMP: Final = 8  # characters of a cursor movement
_COLOURS: Final = 4  # characters around the colours of a pen


def move_to(x: int, y: int) -> str:
    """Move the cursor to ``x``, ``y`` (from 0)."""
    if x:
        return f"\x1b[{y + 1};{x + 1}H"
    return f"\x1b[{y + 1}H" if y else "\x1b[H"


class _Run(NamedTuple):
    """Columns for one pen, or the rest of the line if it ``erases``."""

    y: int
    line: Line
    columns: list[int]
    erases: bool = False


class Encoder:
    """Encodes changed lines for a terminal without wrapping."""

    def __init__(self, pens: Pens, cutter: Cutter) -> None:
        self._pens = pens
        self._cutter = cutter

    def frame(self, changed: Iterable[tuple[int, Line, list[int]]], size: float = inf) -> str:
        """Return the text of a frame, empty if nothing has changed.

        It stops after the line that exceeds about ``size`` characters. It starts and ends with the terminal's
        own colours, for text between frames.
        """
        runs, length = dict[Pen, list[_Run]](), 0
        for y, line, columns in changed:
            for pen, run in self._runs(y, line, columns):
                if pen not in runs:
                    runs[pen] = []
                    length += _COLOURS + len(pen.foreground) + len(pen.background)
                runs[pen].append(run)
                length += _JUMP + len(run.columns)
            if length > size:
                break
        return self._written(runs)

    def _runs(self, y: int, line: Line, columns: list[int]) -> Iterator[tuple[Pen, _Run]]:
        erased = self._erased_from(line, columns)
        kept = columns[: bisect_left(columns, erased)]
        pens = iter(_pens_of(line, kept, self._pens.plain))
        for pen, own in groupby(kept, lambda _: next(pens)):
            yield pen, _Run(y, line, list(own))
        if len(kept) < len(columns):
            yield self._pens.plain, _Run(y, line, [erased], erases=True)

    def _written(self, runs: dict[Pen, list[_Run]]) -> str:
        plain, change, narrow = self._pens.plain, self._pens.change, self._cutter.narrow
        written: list[str] = []
        write = written.append
        pen, row, at = plain, -1, -1  # the current pen and cursor position; −1: unknown
        for wanted in sorted(runs, key=lambda each: (each is plain, *each.order)):
            for y, line, columns, erases in runs[wanted]:
                characters, last = line.cells, len(line.cells) - 1
                for x in columns:
                    if y != row or not 0 <= at <= x:
                        write(move_to(x, y))
                    elif x != at:
                        write(self._way(at, x, line, pen))
                    if pen is not wanted:
                        write(change(pen, wanted))
                        pen = wanted
                    cell = _ERASE_REST if erases else characters[x]
                    write(cell)
                    # terminals disagree about the width of rare characters and about the last column
                    row, at = y, x + 1 if cell in narrow and x < last else -1
        if pen is not plain:
            write(RESET)
        return "".join(written)

    def _way(self, at: int, x: int, line: Line, pen: Pen) -> str:
        """Return the shortest way to column ``x``. It may write cells again."""
        step = f"\x1b[{x - at}C" if x - at > 1 else "\x1b[C"
        if x - at <= len(step):
            between = "".join(line.cells[at:x])
            if len(between.encode()) <= len(step) and self._cutter.narrow.issuperset(between):
                seen = zip(line.cells[at:x], line.pens[at:x], strict=True)
                if all(other is pen or (cell == " " and other.blank is pen.blank) for cell, other in seen):
                    return between
        return step

    def _erased_from(self, line: Line, columns: list[int]) -> int:
        plain, width = self._pens.plain, len(line.cells)
        start = width
        while start and line.cells[start - 1] == " " and line.pens[start - 1].blank is plain:
            start -= 1
        changed = len(columns) - bisect_left(columns, start)
        return start if changed > _WORTH_ERASING else width


def _pens_of(line: Line, columns: list[int], pen: Pen) -> list[Pen]:
    """Return each column's pen. Blanks may take any that looks the same."""
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
    """Return the next character's pen if the blank looks the same with it."""
    blank = line.pens[columns[number]].blank
    x = columns[number]
    for other in columns[number:]:
        if other != x or line.pens[x].blank is not blank:
            break
        if line.cells[x] != " ":
            return line.pens[x]
        x += 1
    return blank
