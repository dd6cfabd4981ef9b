"""How large the cells of a map are drawn."""

from __future__ import annotations

from typing import Final, NamedTuple

LEAST_DIGITS: Final = 3  # .54
MOST_DIGITS_NEEDED: Final = 4  # −100, −12k
_WITH_DIGITS: Final = 2  # mark and arrow beside a value in one row
LEAST_ARROWS: Final = 2  # mark and arrow
MOST_HEIGHT: Final = 5
_WITH_CORNER: Final = 10  # of two rows


class CellForm(NamedTuple):
    """Characters a cell: one row has the value beside the arrow, more have it below.

    Values need ``least_digits`` characters.
    """

    width: int
    height: int
    least_digits: int = LEAST_DIGITS

    @property
    def has_values(self) -> bool:
        """Whether there is room for V(s); narrower cells have mark and arrow alone."""
        return self.width >= _least_width(self.height, self.least_digits)

    @property
    def most_signs(self) -> int:
        """How many greedy actions a cell without a mark has room for."""
        if not self.has_values:
            return 1
        return self.width - 2 if self.height > 1 else max(1, self.width - self.digits - 1)

    @property
    def has_corner(self) -> bool:
        """Whether the name of a state has room in the corner; elsewhere it takes the place of the value."""
        return self.height > 2 or (self.height == 2 and self.width >= _WITH_CORNER)

    @property
    def longest_name(self) -> int:
        """How many characters of the name of a state there is room for."""
        return self.digits if self.has_values and not self.has_corner else self.width - 1

    @property
    def digits(self) -> int:
        """The characters that a value has."""
        if self.height == 1:
            return self.least_digits if self.width < 8 else 4
        return 6 if self.width >= 12 else min(4, self.width - 1)


def digits_needed(least: float) -> int:
    """Return the characters that values from ``least`` on can be written in: 4 below −99, else 3."""
    return LEAST_DIGITS if least > -99.5 else MOST_DIGITS_NEEDED


def cell_form(rows: int, columns: int, width: int, height: int, digits: int = LEAST_DIGITS) -> CellForm:
    """Return the largest form in which rows × columns cells fit into width × height characters.

    Values need ``digits`` characters. Where they fit only without their values, they go without. Where even
    then they do not, the form is the smallest with values: a part of the map is in view.
    """
    if rows > height or columns * LEAST_ARROWS > width:
        # more than fits scrolls anyway: a long value is kept apart from its arrows
        least = _least_width(1, digits) + (digits > LEAST_DIGITS)
        return CellForm(max(least, min(8, width // columns)), 1, digits)
    cell_height = min(MOST_HEIGHT, height // rows)
    if columns * _least_width(cell_height, digits) > width:
        return CellForm(width // columns, 1, digits)
    widest = max(8, 4 * cell_height + 2)  # characters are about twice as high as wide
    return CellForm(min(widest, width // columns), cell_height, digits)


def _least_width(height: int, digits: int) -> int:
    """Return the width from which a cell has room for its value: beside the arrow, or in a row of its own."""
    return digits + (_WITH_DIGITS if height == 1 else 1)
