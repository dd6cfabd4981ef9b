"""How large the cells of a map are drawn."""

from __future__ import annotations

from typing import NamedTuple

LEAST_WIDTH = 5  # mark, arrow and a value of three characters
MOST_HEIGHT = 5


class CellForm(NamedTuple):
    """Characters a cell: one row has the value beside the arrow, more have it below."""

    width: int
    height: int


def cell_form(rows: int, columns: int, width: int, height: int) -> CellForm:
    """Return the largest form in which rows × columns cells fit into width × height characters.

    Where not even the smallest fits, it is the smallest, so that as much as possible is in view.
    """
    fits = rows <= height and columns * LEAST_WIDTH <= width
    cell_height = min(MOST_HEIGHT, height // rows) if fits else 1
    widest = max(8, 4 * cell_height + 2)  # characters are about twice as high as wide
    return CellForm(max(LEAST_WIDTH, min(widest, width // columns)), cell_height)
