"""Lines made of pieces in different styles, of which the last ones are left out where room is short."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Final

from rich.cells import cell_len
from rich.style import Style
from textual.strip import Strip

from rl_tui.tui.draw.canvas import Canvas, shortened
from rl_tui.tui.draw.to_ascii import to_ascii
from rl_tui.tui.theme.look import Look

KEPT_BLANK: Final = "\x1f"  # in texts to be wrapped: a blank at which no line ends


def kept(text: str) -> str:
    """Return ``text`` so that :func:`wrapped` ends no line within it."""
    return text.replace(" ", KEPT_BLANK)


@dataclass(frozen=True, slots=True)
class Piece:
    """A text that is shown whole or not at all; blanks at its start set it off from the one before."""

    text: str
    style: Style


Line = Sequence[Piece]


def spelled(line: Line, look: Look) -> list[Piece]:
    """Return ``line`` in the characters that the terminal has."""
    return [Piece(to_ascii(piece.text, look.glyphs), piece.style) for piece in line]


def length(line: Line) -> int:
    """Return how many cells ``line`` takes."""
    return sum(cell_len(piece.text) for piece in line)


def fitted(line: Line, width: int, look: Look) -> list[Piece]:
    """Return the first pieces of ``line`` that fit into ``width`` cells; the first shortened if need be."""
    kept: list[Piece] = []
    room = width
    for piece in spelled(line, look):
        if cell_len(piece.text) > room:
            if not kept:
                kept.append(Piece(shortened(piece.text, width, look.glyphs.ellipsis), piece.style))
            break
        kept.append(piece)
        room -= cell_len(piece.text)
    return kept


def first_that_fits(forms: Iterable[Line], width: int, look: Look) -> Line:
    """Return the first of ``forms``, longest first, that fits into ``width`` cells, else the last."""
    form: Line = ()
    for form in forms:
        if length(spelled(form, look)) <= width:
            break
    return form


def strips_of(lines: Sequence[Line], width: int, height: int, look: Look) -> list[Strip]:
    """Return the first ``height`` of ``lines`` as strips, blank ones below them."""
    canvas = Canvas(width, height, look.palette.text)
    for y, line in enumerate(lines[:height]):
        x = 0
        for piece in fitted(line, width, look):
            canvas.put(x, y, piece.text, piece.style)
            x += cell_len(piece.text)
    return canvas.strips()


def wrapped(
    text: str, width: int, style: Style, look: Look, first: str = "", rest: str = ""
) -> list[list[Piece]]:
    """Return ``text`` as lines of at most ``width`` cells, broken at blanks, but not at KEPT_BLANK.

    ``first`` stands before the first line, ``rest`` before the others; a word that is too long has its own.
    """
    lines: list[str] = []
    current = first
    is_begun = False
    for word in to_ascii(text, look.glyphs).split(" "):
        shown = word.replace(KEPT_BLANK, " ")
        candidate = f"{current} {shown}" if is_begun else current + shown
        if is_begun and cell_len(candidate) > width:
            lines.append(current)
            candidate = rest + shown
        current, is_begun = candidate, True
    return [[Piece(line, style)] for line in (*lines, current)]
