"""Blocks that fit into a width."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final, NamedTuple, Protocol

from rich.cells import cell_len
from rich.style import Style

from rl_tui.screen.draw.canvas import (
    Line,
    Piece,
    first_that_fits,
    fitted,
    length,
    shortened,
    spelled,
    wrapped,
)
from rl_tui.screen.theme.look import Look


class Block(Protocol):
    """A group of lines in a panel."""

    def lines(self, width: int, look: Look) -> Sequence[Line]:
        """Return lines that fit if possible."""


def lines_of(blocks: Iterable[Block], width: int, look: Look) -> list[Line]:
    """Join the lines of all ``blocks``."""
    return [line for block in blocks for line in block.lines(width, look)]


@dataclass(frozen=True, slots=True)
class Text:
    """A paragraph, or a function of the width."""

    text: str | Callable[[int], str]
    style: Style
    first: str = " "
    rest: str = " "

    def lines(self, width: int, look: Look) -> Sequence[Line]:
        """Wrap the text."""
        text = self.text if isinstance(self.text, str) else self.text(width)
        return wrapped(text, width, self.style, look, self.first, self.rest) if text else ()


class Row:
    """The first fitting form, else ``instead``, else the last form."""

    def __init__(self, *forms: Line, instead: Sequence[Block] = ()) -> None:
        self._forms = forms
        self._instead = instead

    def lines(self, width: int, look: Look) -> Sequence[Line]:
        """Return the line, or those of ``instead``."""
        line = first_that_fits(self._forms, width, look)
        if self._instead and length(spelled(line, look)) > width:
            return lines_of(self._instead, width, look)
        return [line]


BLANK = Row([])


@dataclass(frozen=True, slots=True)
class Flow:
    """Unbreakable groups of pieces, wrapped over lines."""

    groups: Iterable[Line]
    indent: int = 1

    def lines(self, width: int, look: Look) -> Sequence[Line]:
        """Wrap, without leading blanks."""
        lines: list[list[Piece]] = []
        used = 0
        for group in filter(None, self.groups):
            needed = length(spelled(group, look))
            if lines and used + needed <= width:
                lines[-1] += group
                used += needed
                continue
            first, *rest = group
            margin = Piece(" " * (self.indent if lines else 1), look.palette.text)
            lines.append([margin, Piece(first.text.lstrip(" "), first.style), *rest])
            used = length(spelled(lines[-1], look))
        return lines


@dataclass(frozen=True, slots=True)
class Labelled:
    """A block beside its label, or below it in less than ``beside_from`` cells."""

    label: str
    style: Style
    cells: int
    body: Block
    beside_from: int = 0

    def lines(self, width: int, look: Look) -> Sequence[Line]:
        """Return label and body."""
        label = f" {look.glyphs.spelled(self.label)}"
        if width < self.beside_from:
            below = self.body.lines(width - 3, look)
            return [[Piece(label, self.style)], *([Piece("   ", self.style), *line] for line in below)]
        body = self.body.lines(max(1, width - self.cells), look)
        return [
            [Piece(f"{label if number == 0 else '':<{self.cells}}", self.style), *line]
            for number, line in enumerate(body)
        ]


@dataclass(frozen=True, slots=True)
class Section:
    """Blocks below a heading, padded to ``rows``."""

    heading: str
    blocks: Sequence[Block] = ()
    rows: int = 0
    remarks: Sequence[str] = ()

    def lines(self, width: int, look: Look) -> Sequence[Line]:
        """Return heading, rule and blocks."""
        palette = look.palette
        head = Piece(f" {self.heading} ", palette.strong)
        forms = [[head, Piece(f" {remark} ", palette.text)] for remark in self.remarks if remark]
        kept = fitted(first_that_fits([*forms, [head]], width, look), width, look)
        rule = Piece(look.glyphs.thin * max(0, width - length(kept)), palette.dim)
        lines = lines_of(self.blocks, width, look)
        return [[*kept, rule], *lines, *([[]] * (self.rows - len(lines)))]


def stacked(sections: Sequence[Section], width: int, height: int, look: Look) -> list[Line]:
    """Stack ``sections``, spaced if ``height`` allows."""
    parts = [section.lines(width, look) for section in sections]
    is_roomy = sum(map(len, parts)) + len(parts) - 1 <= height
    lines: list[Line] = []
    for part in parts:
        lines += [*([[]] if lines and is_roomy else []), *part]
    return lines


class Column(NamedTuple):
    """A table column. A cell None repeats the head.

    It has at least ``width`` cells after ``gap`` blanks, and can shrink to ``least``.
    """

    head: str
    cells: Sequence[str | Piece | None]
    style: Style
    right: bool = True
    gap: int = 1
    width: int = 0
    least: int | None = None

    def longest(self, look: Look) -> int:
        """Return the longest cell's width."""
        texts = (cell.text if isinstance(cell, Piece) else cell for cell in self.cells if cell is not None)
        return max((cell_len(look.glyphs.spelled(text)) for text in texts), default=0)

    def pieces(self, look: Look) -> list[Piece]:
        """Return head and cells as displayed."""
        head = Piece(self.head, look.palette.dim)
        cells = (
            head if c is None else c if isinstance(c, Piece) else Piece(c, self.style) for c in self.cells
        )
        return spelled([head, *cells], look)


Columns = Sequence[Column]
Size = tuple[int, int]


@dataclass(frozen=True, slots=True)
class Table:
    """A table in the first of ``forms`` that leaves ``margin`` cells free.

    If none fits, an ``is_stacked`` table puts each cell on its own line. So do charts narrower than
    ``least_chart``.
    """

    forms: Iterable[Columns]
    margin: int = 0
    has_head: bool = True
    is_stacked: bool = False
    below: Mapping[int, Sequence[Block]] = field(default_factory=dict)
    charts: Mapping[int, Block] = field(default_factory=dict)
    least_chart: int = 16

    def lines(self, width: int, look: Look) -> Sequence[Line]:
        """Return head and rows."""
        return self.placed(width, look)[0]

    def placed(self, width: int, look: Look) -> tuple[list[Line], list[int]]:
        """Return the lines, and each row's line."""
        columns, widths, fits = self._chosen(width, look)
        pieces = [column.pieces(look) for column in columns]
        aligned = [
            [_aligned(piece, column, cells, look) for piece in texts]
            for column, cells, texts in zip(columns, widths, pieces, strict=True)
        ]
        head_and_rows: list[Line] = [[*row] for row in zip(*aligned, strict=True)]  # empty without columns
        is_stacked = self.is_stacked and not fits
        room = width - sum(widths) - sum(column.gap for column in columns) - 1
        if self.charts and room >= self.least_chart and not is_stacked:
            head_and_rows = [_opened(row, room + 1, look) for row in head_and_rows]
        else:
            room = 0
        lines: list[Line] = [*head_and_rows[:1]] if self.has_head and not is_stacked else []
        places = list[int]()
        for place, row in enumerate(head_and_rows[1:]):
            places.append(len(lines))
            chart = self.charts[place].lines(room or max(1, width - 2), look) if place in self.charts else ()
            if is_stacked:
                lines += _stacked(columns, pieces, place, width, look)
            elif room and chart:
                first, *more = ([Piece(" ", look.palette.text), *line] for line in chart)
                margin = Piece(" " * length(row[:1]), look.palette.text)
                lines += [[row[0], *first, *row[2:]], *([margin, *line] for line in more)]
            else:
                lines += [row, *([Piece(" ", look.palette.text), *line] for line in chart)]
            lines += lines_of(self.below.get(place, ()), width, look)
        return lines, places

    def _chosen(self, width: int, look: Look) -> tuple[Columns, list[int], bool]:
        columns: Columns = ()
        wanted: list[int] = []
        least: list[int] = []
        room = 0
        known: dict[int, tuple[object, int]] = {}  # forms often share cells
        for columns in self.forms:
            for each in columns:
                if id(each.cells) not in known:
                    known[id(each.cells)] = each.cells, each.longest(look)
            heads = [cell_len(look.glyphs.spelled(each.head)) for each in columns]
            wanted = [
                max(c.width, head, known[id(c.cells)][1]) for c, head in zip(columns, heads, strict=True)
            ]
            least = [w if c.least is None else min(w, c.least) for c, w in zip(columns, wanted, strict=True)]
            room = width - sum(least) - sum(each.gap for each in columns)
            if room >= (self.margin if least == wanted else 0):
                break
        cells = [min(w, each + max(0, room)) for w, each in zip(wanted, least, strict=True)]
        return columns, cells, room >= 0


def _aligned(piece: Piece, column: Column, cells: int, look: Look) -> Piece:
    text = shortened(piece.text, cells, look.glyphs.ellipsis)
    blanks = " " * (cells - cell_len(text))
    gap = " " * column.gap
    return Piece(gap + (blanks + text if column.right else text + blanks), piece.style)


def _opened(row: Line, cells: int, look: Look) -> Line:
    return [*row[:1], Piece(" " * cells, look.palette.text), *row[1:]]


def _stacked(
    columns: Columns, pieces: Sequence[Sequence[Piece]], place: int, width: int, look: Look
) -> Iterator[Line]:
    (_, *names), *others = pieces
    if names[place].text:
        yield [Piece(f" {shortened(names[place].text, width - 1, look.glyphs.ellipsis)}", names[place].style)]
    for column, (head, *cells) in zip(columns[1:], others, strict=True):
        if column.cells[place] is not None:
            text, style = cells[place].text, cells[place].style
            labelled = [Piece(f"   {head.text} ", head.style), Piece(text, style)]
            yield from Row(labelled, [Piece(f"  {text}", style)]).lines(width, look)


class Laid(NamedTuple):
    """Lines, each table row's line, and the free lines."""

    lines: list[Line]
    places: Sequence[int]
    free: int


def laid(
    tables: Iterable[Table],
    cursor: int,
    answer: Iterable[Text],
    notes: Iterable[Text],
    size: Size,
    look: Look,
) -> Laid:
    """Arrange ``answer``, the first fitting table and ``notes``, else the rows around ``cursor``."""
    width, height = size
    said = [note.lines(width, look) for note in notes]
    above = lines_of(answer, width, look)
    above += [[]] if above else []
    lines, places = list[Line](), list[int]()
    for table in tables:
        lines, places = table.placed(width, look)
        if len(above) + len(lines) + 1 + sum(map(len, said)) <= height:
            break
    if len(above) + len(lines) > height:
        above = []
    if len(lines) > height:
        has_head = height > len(places)
        first = max(0, min(cursor - height // 2, len(places) - height))
        lines = [*(lines[:1] if has_head else ()), *lines[places[0] :][first : first + height]]
        places = [has_head + place - first for place in range(len(places))]
    top = len(above) + len(lines)
    lines = [*above, *lines]
    for note in said:
        gap = int(len(lines) == top and height - top > len(note))
        if len(lines) + gap + len(note) <= height:
            lines += [*([[]] * gap), *note]
    return Laid(lines, [len(above) + place for place in places], height - len(lines))


# An equation


_INDENT: Final = "   "


class Term(NamedTuple):
    """A ``number`` after an ``operator``, below a ``word``."""

    operator: str
    word: str = ""
    number: str = ""
    style: Style | None = None


@dataclass(frozen=True, slots=True)
class Equation:
    """Words above numbers, and ``label`` at a brace below."""

    left: Term
    terms: Sequence[Term]
    label: Piece

    def numbers(self, look: Look) -> list[Line]:
        """Return the numbers with their operators."""
        text = look.palette.text
        first, *others = self.terms
        groups: list[list[Piece]] = [[Piece(first.number, first.style or text)]]
        for term in others:
            pieces = [Piece(term.operator, text), Piece(term.number, term.style or text)]
            groups.append(groups.pop() + pieces if term.operator == ")" else pieces)
        return [*groups]

    def lines(self, width: int, look: Look) -> Sequence[Line]:
        """Return words and numbers, and a brace unless wrapped."""
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
                start = column + cell_len(look.glyphs.spelled(term.operator)) - 1
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
    palette, words, numbers = look.palette, indent, list[Piece]()
    before = indent  # text before the next styled number
    for place, term in enumerate(terms):
        operator, word, number = (look.glyphs.spelled(each) for each in term[:3])
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
    operator, word, number = (cell_len(look.glyphs.spelled(each)) for each in term[:3])
    return operator + max(word, number)
