"""An atlas in the terminal: a cell for each pair of values, with its number and a colour behind it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product
from typing import TYPE_CHECKING, Final

from rich.cells import cell_len
from rich.color import ColorSystem

from rl_tui.lab.pictures.axis import number_text
from rl_tui.lab.pictures.picture import AtlasChart
from rl_tui.tui.draw.canvas import shortened
from rl_tui.tui.theme.palette import palette_for

if TYPE_CHECKING:
    from rl_tui.tui.theme.palette import Depth

BEST, ALIKE, MISSING = "*", "'", "-"
_SYSTEMS: Final = {
    "16": ColorSystem.STANDARD,
    "256": ColorSystem.EIGHT_BIT,
    "truecolor": ColorSystem.TRUECOLOR,
}
_MOST_NAME: Final = 16
_DIGITS: Final = 3
_TINT: Final = 2  # columns of a cell that has a colour and no number
_MOST_BLOCKS: Final = 2
_SCALE: Final = 20  # columns of the scale that says what colours mean


def atlas_lines(atlas: AtlasChart, columns: int, depth: Depth) -> Iterator[str]:
    """Yield the lines of ``atlas``, the highest row first.

    Where ``columns`` has no room for the numbers of all cells side by side, they come in blocks below one
    another. Where that would be more than two, cells are colours alone, if there are any and room for them.
    """
    numbers = _Cells(atlas, depth)
    left = max(cell_len(name) for name in numbers.row_names) + 2
    room = columns - left
    yield f"{atlas.y_label} ↑  {atlas.x_label} →"
    at_once = max(1, room // numbers.width)
    is_long = len(atlas.columns) > _MOST_BLOCKS * at_once
    if is_long and depth != "none" and _TINT * len(atlas.columns) <= room:
        yield from _tints(numbers, left)
    else:
        for first in range(0, len(atlas.columns), at_once):
            if first:
                yield ""
            yield from _block(numbers, left, range(first, min(first + at_once, len(atlas.columns))))
    marks = [f"{BEST} the best"] if atlas.best is not None else []
    if numbers.marked:
        marks.append(f"{ALIKE} not different from the best")
    if marks:
        yield "   ".join(marks)


class _Cells:
    """The cells of an atlas as texts with colours."""

    def __init__(self, atlas: AtlasChart, depth: Depth) -> None:
        self.atlas = atlas
        self.depth: Depth = depth
        self.marked = atlas.marked
        self.row_names = [shortened(name, _MOST_NAME, "…") for name in atlas.rows]
        self.column_names = [shortened(name, _MOST_NAME, "…") for name in atlas.columns]
        places = product(range(len(atlas.rows)), range(len(atlas.columns)))
        texts = [self._number(row, column) for row, column in places]
        self.width = 2 + max(map(cell_len, (*texts, *self.column_names)))
        """Columns of a cell with its number, one of them between it and the next."""

    def mark(self, row: int, column: int) -> str:
        """Return what says how a cell compares with the best; a blank where nothing is said."""
        if self.atlas.best == (row, column):
            return BEST
        return ALIKE if (row, column) in self.marked else " "

    def _number(self, row: int, column: int) -> str:
        value = self.atlas.values[row][column]
        return f"{MISSING} " if value is None else number_text(value, _DIGITS) + self.mark(row, column)

    def number(self, row: int, column: int) -> str:
        """Return a cell with its number."""
        text = self._number(row, column)
        blanks = " " * (self.width - 1 - cell_len(text))
        return self.tinted(blanks + text, self.atlas.values[row][column])

    def tint(self, row: int, column: int) -> str:
        """Return a cell without its number."""
        value = self.atlas.values[row][column]
        return self.tinted(f"{' ' if value is not None else MISSING}{self.mark(row, column)}", value)

    def tinted(self, text: str, value: float | None) -> str:
        """Return ``text`` with the colour of ``value`` behind it."""
        if self.depth == "none" or value is None:
            return text
        style = palette_for(self.depth, True).value(self.atlas.scale.share(value))
        return style.render(text, color_system=_SYSTEMS[self.depth])


def _block(cells: _Cells, left: int, shown: Sequence[int]) -> Iterator[str]:
    """Yield the columns ``shown``, with their numbers."""
    for row in reversed(range(len(cells.atlas.rows))):
        numbers = " ".join(cells.number(row, column) for column in shown)
        yield f"{cells.row_names[row]:>{left - 2}}  {numbers}".rstrip()
    names = " ".join(f"{cells.column_names[column]:>{cells.width - 1}}" for column in shown)
    yield f"{'':{left}}{names}"


def _tints(cells: _Cells, left: int) -> Iterator[str]:
    """Yield all columns as colours, as many names as there is room for, and what the colours mean."""
    atlas = cells.atlas
    for row in reversed(range(len(atlas.rows))):
        tints = "".join(cells.tint(row, column) for column in range(len(atlas.columns)))
        yield f"{cells.row_names[row]:>{left - 2}}  {tints}"
    names = " " * left
    for column, name in enumerate(cells.column_names):
        start = left + _TINT * column
        if start >= len(names) and start + cell_len(name) <= left + _TINT * len(atlas.columns):
            names = f"{names:{start}}{name} "
    yield names.rstrip()
    scale = atlas.scale
    steps = (scale.low + (scale.high - scale.low) * (place + 0.5) / _SCALE for place in range(_SCALE))
    shown = "".join(cells.tinted(" ", value) for value in steps)
    yield f"{'':{left}}{scale.labels[0]} {shown} {scale.labels[-1]}"
