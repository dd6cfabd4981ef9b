"""An equation with numbers: a word above each number, and a brace below the part that is its error."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final, NamedTuple

from rich.cells import cell_len
from rich.style import Style

from rl_tui.screen.draw.canvas import Line, Piece, spelled
from rl_tui.screen.draw.to_ascii import to_ascii
from rl_tui.screen.theme.look import Look

_INDENT: Final = "   "


class Term(NamedTuple):
    """A ``number`` behind an ``operator``, with a ``word`` above it. A bracket that closes has neither."""

    operator: str
    word: str = ""
    number: str = ""
    style: Style | None = None


@dataclass(frozen=True, slots=True)
class Equation:
    """``left`` and the ``terms`` that give it; a brace with the ``label`` joins their brackets, if any.

    ``now = was + α·(r − was)`` is written above its numbers, each word in the column of its number.
    """

    left: Term
    terms: Sequence[Term]
    label: Piece

    def numbers(self, look: Look) -> list[Line]:
        """Return the numbers that give the left side, none of which is to be broken off its operator."""
        text = look.palette.text
        first, *others = self.terms
        groups: list[list[Piece]] = [[Piece(first.number, first.style or text)]]
        for term in others:
            pieces = [Piece(term.operator, text), Piece(term.number, term.style or text)]
            groups.append(groups.pop() + pieces if term.operator == ")" else pieces)
        return [*groups]

    def lines(self, width: int, look: Look) -> Sequence[Line]:
        """Return words, numbers and brace; too wide for that, several lines of words and numbers."""
        terms = [self.left, *self.terms]
        if 1 + sum(_cells(term, look) for term in terms) <= width:
            return [*_pair(terms, " ", look), *self._brace(look)]
        parts = enumerate(_broken(terms, width, look))
        return [line for place, part in parts for line in _pair(part, _INDENT if place else " ", look)]

    def _brace(self, look: Look) -> Iterator[Line]:
        start = end = 0
        column = 1 + _cells(self.left, look)
        for term in self.terms:
            if term.operator.endswith("("):
                start = column + cell_len(to_ascii(term.operator, look.glyphs)) - 1
            if term.operator == ")":
                end = column
            column += _cells(term, look)
        if end > start:
            glyphs, (label,) = look.glyphs, spelled([self.label], look)
            text = f" {label.text} ".center(end - start - 1, glyphs.thin)
            corners = glyphs.round_corners
            brace = f"{corners[2]}{text}{corners[3]}"
            yield [Piece(" " * start, look.palette.text), Piece(brace, label.style)]


def _broken(terms: Sequence[Term], width: int, look: Look) -> Iterator[Sequence[Term]]:
    """Yield ``terms`` in parts that fit into a line each: two, before the bracket and from it on, or more."""
    start = next((place for place, term in enumerate(terms) if term.operator.endswith("(")), 0)
    if start and max(
        sum(_cells(each, look) for each in part) for part in (terms[:start], terms[start:])
    ) < width - len(_INDENT):
        yield terms[:start]
        yield terms[start:]
        return
    part: list[Term] = []
    used = 1
    for term in terms:
        cells = _cells(term, look)
        if part and used + cells > width and term.operator != ")":
            yield part
            part, used = [], len(_INDENT)
        part.append(term)
        used += cells
    yield part


def _pair(terms: Sequence[Term], indent: str, look: Look) -> tuple[Line, Line]:
    """Return the line of the words and the line of the numbers."""
    palette, words, numbers = look.palette, indent, list[Piece]()
    before = indent  # the text before the next number with a style of its own
    for place, term in enumerate(terms):
        operator, word, number = (to_ascii(each, look.glyphs) for each in term[:3])
        operator = operator if place else operator.lstrip()
        cells = max(cell_len(word), cell_len(number))
        words += operator + word.ljust(cells)
        padding = " " * (cells - cell_len(number))
        if term.style in (None, palette.text):
            before += operator + number + padding
        else:
            numbers += [Piece(before + operator, palette.text), Piece(number, term.style)]
            before = padding
    return [Piece(words, palette.dim)], [*numbers, Piece(before, palette.text)]


def _cells(term: Term, look: Look) -> int:
    operator, word, number = (cell_len(to_ascii(each, look.glyphs)) for each in term[:3])
    return operator + max(word, number)
