"""An atlas in the terminal: a cell for each pair of values, with its number and a colour behind it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Final

from rich.cells import cell_len
from rich.color import ColorSystem

from rl_tui.lab.pictures.axis import number_text
from rl_tui.lab.pictures.picture import Atlas
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


def atlas_lines(atlas: Atlas, columns: int, depth: Depth) -> Iterator[str]:
    """Yield the lines of ``atlas``, the highest row first.

    Where ``columns`` has no room for all cells side by side, they come in blocks below one another.
    """
    marked = atlas.marked
    texts = [
        [_text(atlas, marked, row, column) for column in range(len(atlas.columns))]
        for row in range(len(atlas.rows))
    ]
    left = max(min(_MOST_NAME, cell_len(name)) for name in atlas.rows) + 2
    width = 1 + max(
        *(cell_len(text) for row in texts for text in row),
        *(min(_MOST_NAME, cell_len(name)) for name in atlas.columns),
    )
    at_once = max(1, (columns - left) // (width + 1))
    yield f"{atlas.y_label} ↑  {atlas.x_label} →"
    for first in range(0, len(atlas.columns), at_once):
        shown = range(first, min(first + at_once, len(atlas.columns)))
        if first:
            yield ""
        for row in reversed(range(len(atlas.rows))):
            cells = [_cell(atlas, texts, row, column, width, depth) for column in shown]
            yield f"{shortened(atlas.rows[row], _MOST_NAME, '…'):>{left - 2}}  {' '.join(cells)}".rstrip()
        names = [shortened(atlas.columns[column], _MOST_NAME, "…").rjust(width) for column in shown]
        yield f"{'':{left}}{' '.join(names)}"
    marks = [f"{BEST} the best"] if atlas.best is not None else []
    if atlas.marked:
        marks.append(f"{ALIKE} not different from the best")
    if marks:
        yield "   ".join(marks)


def _text(atlas: Atlas, marked: set[tuple[int, int]], row: int, column: int) -> str:
    value = atlas.values[row][column]
    if value is None:
        return MISSING + " "
    mark = BEST if atlas.best == (row, column) else ALIKE if (row, column) in marked else " "
    return number_text(value, _DIGITS) + mark


def _cell(atlas: Atlas, texts: list[list[str]], row: int, column: int, width: int, depth: Depth) -> str:
    text, value = texts[row][column].rjust(width), atlas.values[row][column]
    if depth == "none" or value is None:
        return text
    style = palette_for(depth, True).value(atlas.scale.share(value))
    return style.render(text, color_system=_SYSTEMS[depth])
