"""How large the cells of a map are drawn."""

from __future__ import annotations

from typing import Final, NamedTuple

LEAST_DIGITS: Final = 3  # .54
MOST_DIGITS_NEEDED: Final = 4  # −100, −12k
_WITH_DIGITS: Final = 2  # mark and arrow beside a value in one row
LEAST_ARROWS: Final = 2  # mark and arrow
MOST_HEIGHT: Final = 5
_WITH_CORNER: Final = 10  # of two rows
_LEAST_WITH_SEAM: Final = 5
_LEAST_BLOCKS: Final = (7, 3)
_LEAST_PLATE: Final = (9, 4)
_LEAST_START: Final = 13
_LEAST_NUMBERED: Final = (11, 5)


class CellForm(NamedTuple):
    """Characters a cell, and by its size what is drawn in it. Values need ``least_digits`` characters.

    From 7 × 3 on the greedy action is an arrow of blocks above the value, in lower or narrower cells a
    letter; in one row the letter stands before the value. From 5 columns on a seam at the right and, in three
    rows and more, one below keep a cell apart from its neighbours, where there is room for it.
    """

    width: int
    height: int
    least_digits: int = LEAST_DIGITS

    @property
    def has_values(self) -> bool:
        """Whether there is room for V(s); narrower cells have mark and arrow alone."""
        return self.width >= _least_width(self.height, self.least_digits)

    @property
    def has_seam(self) -> bool:
        """Whether the last column is a seam."""
        is_free = self.height > 1 or self.width != _least_width(1, self.least_digits)
        return self.width >= _LEAST_WITH_SEAM and is_free

    @property
    def inner(self) -> int:
        """The columns without the seam."""
        return self.width - self.has_seam

    @property
    def has_blocks(self) -> bool:
        """Whether signs are made of blocks, where there are any, and the way of a step is shown."""
        return self.width >= _LEAST_BLOCKS[0] and self.height >= _LEAST_BLOCKS[1]

    @property
    def has_plate(self) -> bool:
        """Whether the agent is a disc of blocks."""
        return self.width >= _LEAST_PLATE[0] and self.height >= _LEAST_PLATE[1]

    @property
    def has_number(self) -> bool:
        """Whether the corner always has the number of the state."""
        return self.width >= _LEAST_NUMBERED[0] and self.height >= _LEAST_NUMBERED[1]

    @property
    def says_start(self) -> bool:
        """Whether there is room for more than a letter where episodes start."""
        return self.width >= _LEAST_START and self.height > 1

    @property
    def value_row(self) -> int:
        """The row of the value, which is where the cursor is drawn."""
        return self.height - 1

    @property
    def most_signs(self) -> int:
        """How many greedy actions a cell without a mark has room for, as letters."""
        if not self.has_values:
            return 1
        return self.width - 2 if self.height > 1 else max(1, self.inner - self.digits - 1)

    @property
    def has_corner(self) -> bool:
        """Whether the name of a state has room in the corner; elsewhere it takes the place of the value."""
        return self.height > 2 or (self.height == 2 and self.width >= _WITH_CORNER)

    @property
    def longest_name(self) -> int:
        """How many characters of the name of a state there is room for."""
        return self.digits if self.has_values and not self.has_corner else self.width - 1

    @property
    def most_digits(self) -> int:
        """The characters that there are for a whole number."""
        return self.inner if self.height > 1 else self.digits

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
