"""Texts cut into the cells of a screen."""

from __future__ import annotations

from unicodedata import category

from rich.cells import split_graphemes

UNKNOWN = "\0"  # it is not known what stands in such a cell


class Cutter:
    """Cuts texts into cells, as they were counted when the screen was laid out.

    A cell is one character with what combines with it; of a wide one, the second cell is the empty text.
    """

    def __init__(self) -> None:
        self.narrow = {chr(code) for code in range(0x20, 0x7F)}
        """Characters known to fill one cell, as every terminal has it."""

    def cells(self, text: str) -> list[str]:
        """Return the cells of ``text``, a sequence as long as the text is wide.

        Control characters have no width, and would steer the terminal: they are left out.
        """
        cells: list[str] = []
        text = "".join(character for character in text if category(character) != "Cc")
        for start, end, width in split_graphemes(text)[0]:
            cell = text[start:end]
            if width == 0:
                continue
            if width == 1 and len(cell) == 1:
                self.narrow.add(cell)
            cells.append(cell)
            cells.extend([""] * (width - 1))
        return cells
