"""How large the cells of a map are drawn."""

from __future__ import annotations

from typing import Final, NamedTuple

LEAST_WIDTH: Final = 5  # mark, arrow and a value of three characters
LEAST_ARROWS: Final = 2  # mark and arrow
MOST_HEIGHT: Final = 5


class CellForm(NamedTuple):
    """Characters a cell: one row has the value beside the arrow, more have it below."""

    width: int
    height: int

    @property
    def has_values(self) -> bool:
        """Whether there is room for V(s); narrower cells have mark and arrow alone."""
        return self.width >= LEAST_WIDTH

    @property
    def digits(self) -> int:
        """The characters that a value has."""
        if self.height == 1:
            return 3 if self.width < 8 else 4
        return 4 if self.width < 12 else 6


def cell_form(rows: int, columns: int, width: int, height: int) -> CellForm:
    """Return the largest form in which rows × columns cells fit into width × height characters.

    Where they fit only without their values, they go without. Where even then they do not, the form is the
    smallest with values: a part of the map is in view.
    """
    if rows > height or columns * LEAST_ARROWS > width:
        return CellForm(max(LEAST_WIDTH, min(8, width // columns)), 1)
    if columns * LEAST_WIDTH > width:
        return CellForm(width // columns, 1)
    cell_height = min(MOST_HEIGHT, height // rows)
    widest = max(8, 4 * cell_height + 2)  # characters are about twice as high as wide
    return CellForm(min(widest, width // columns), cell_height)
