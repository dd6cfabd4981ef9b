"""The size of map cells."""

from __future__ import annotations

from typing import Final, NamedTuple

from rl_tui.screen.draw.block_signs import sign_size

LEAST_DIGITS: Final = 3  # .54
MOST_DIGITS_NEEDED: Final = 4  # −100, −12k
_WITH_DIGITS: Final = 2  # mark and arrow beside a value in one row
LEAST_ARROWS: Final = 2  # mark and arrow
MOST_HEIGHT: Final = 5
_HIGHEST: Final = 12  # rows of a cell that is not higher than wide
_WITH_CORNER: Final = 10  # columns of a cell with two rows
_LEAST_WITH_SEAM: Final = 5
_LEAST_BLOCKS: Final = (7, 3)
_LEAST_PLATES: Final = ((23, 8, 4), (17, 6, 3))  # columns and rows of a cell, rows of the agent's plate
_LEAST_WITH_BLOCK_VALUES: Final = 9  # rows of a cell
_AROUND_AN_ARROW: Final = 5  # rows of a value in blocks, and one above and below the arrow
_LEAST_START: Final = 13
_LEAST_NUMBERED: Final = (11, 5)


class CellForm(NamedTuple):
    """A cell's size in characters, which decides its contents.

    From 7 × 3 on, the greedy action is a block arrow, else a letter. From 5 columns on, seams separate
    neighbours if they fit.
    """

    width: int
    height: int
    least_digits: int = LEAST_DIGITS

    @property
    def has_values(self) -> bool:
        """True if V(s) fits beside the arrow."""
        return self.width >= _least_width(self.height, self.least_digits)

    @property
    def has_seam(self) -> bool:
        """True if the last column is a seam."""
        is_free = self.height > 1 or self.width != _least_width(1, self.least_digits)
        return self.width >= _LEAST_WITH_SEAM and is_free

    @property
    def inner(self) -> int:
        """The columns without seam."""
        return self.width - self.has_seam

    def centred(self, length: int, *, as_blocks: bool) -> int:
        """Return where a text starts. Blocks leave the seam out, letters and numbers have one axis."""
        if as_blocks:
            return (self.inner - length) // 2
        if self.height == 1 and self.width == LEAST_ARROWS:
            return 1  # after the mark
        return max(0, min((self.width - length + self.width % 2) // 2, self.inner - length))

    @property
    def has_blocks(self) -> bool:
        """True if arrows and ends are blocks, and step paths shown."""
        return self.width >= _LEAST_BLOCKS[0] and self.height >= _LEAST_BLOCKS[1]

    @property
    def has_block_values(self) -> bool:
        """True if values have three rows."""
        return self.height >= _LEAST_WITH_BLOCK_VALUES

    @property
    def arrow_rows(self) -> int:
        """The rows of a block arrow."""
        rows = sign_size(self.width, self.height)[1]
        return min(rows, self.height - _AROUND_AN_ARROW) if self.has_block_values else rows

    @property
    def plate_rows(self) -> int:
        """The agent's rows in blocks, 0 for a letter."""
        sizes = (
            rows for width, height, rows in _LEAST_PLATES if self.width >= width and self.height >= height
        )
        return next(sizes, 0)

    @property
    def has_number(self) -> bool:
        """True if the corner always has the number."""
        return self.width >= _LEAST_NUMBERED[0] and self.height >= _LEAST_NUMBERED[1]

    @property
    def says_start(self) -> bool:
        """True if the start has more than a letter."""
        return self.width >= _LEAST_START and self.height > 1

    @property
    def value_row(self) -> int:
        """The row of value and cursor."""
        return self.height - 1

    @property
    def most_signs(self) -> int:
        """The greedy letters in an unmarked cell."""
        if not self.has_values:
            return 1
        if self.has_blocks:  # more would be wider than the arrows of other cells
            return (self.width - 1) // 2
        return self.width - 2 if self.height > 1 else max(1, self.inner - self.digits - 1)

    @property
    def has_corner(self) -> bool:
        """True if names have a corner, or replace the value."""
        return self.height > 2 or (self.height == 2 and self.width >= _WITH_CORNER)

    @property
    def longest_name(self) -> int:
        """The longest state name."""
        return self.digits if self.has_values and not self.has_corner else self.width - 1

    @property
    def most_digits(self) -> int:
        """The characters of a whole number."""
        return self.width - 1 if self.height > 1 else self.digits

    @property
    def digits(self) -> int:
        """The characters of a value."""
        if self.height == 1:
            return self.least_digits if self.width < 8 else 4
        return 6 if self.width >= 12 else max(LEAST_DIGITS, min(4, self.width - 1))


def digits_needed(least: float) -> int:
    """Return the width of values ≥ ``least``: 4 below −99, else 3."""
    return LEAST_DIGITS if least > -99.5 else MOST_DIGITS_NEEDED


def cell_form(rows: int, columns: int, width: int, height: int, digits: int = LEAST_DIGITS) -> CellForm:
    """Return the largest form in which all cells fit, with values of ``digits`` characters.

    Values go first. If the map still does not fit, the smallest form with values shows a part.
    """
    if rows > height or columns * LEAST_ARROWS > width:
        # the map scrolls anyway, so separate long values from arrows
        least = _least_width(1, digits) + (digits > LEAST_DIGITS)
        return CellForm(max(least, min(8, width // columns)), 1, digits)
    most = max(MOST_HEIGHT, min(_HIGHEST, (width // columns + 1) // 2))
    cell_height = min(most, height // rows)
    if columns * _least_width(cell_height, digits) > width:
        return CellForm(width // columns, 1, digits)
    widest = max(8, 4 * cell_height + 2)  # characters are about twice as high as wide
    return CellForm(min(widest, width // columns), cell_height, digits)


def _least_width(height: int, digits: int) -> int:
    return digits + (_WITH_DIGITS if height == 1 else 1)  # a seam or blank separates neighbours
