"""A canvas of character cells, and styled lines."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain, groupby
from typing import Final

from rich.cells import cell_len
from rich.segment import Segment
from rich.style import Style
from textual.strip import Strip

from rl_tui.screen.theme.look import Look


class Canvas:
    """Width × height cells. Everything outside is clipped."""

    def __init__(self, width: int, height: int, style: Style) -> None:
        self.width = width
        self.height = height
        self._characters = [[" "] * width for _ in range(height)]
        self._styles = [[style] * width for _ in range(height)]

    def put(self, x: int, y: int, text: str, style: Style) -> None:
        """Write ``text`` from column ``x`` on."""
        if not 0 <= y < self.height:
            return
        cells = list(text) if cell_len(text) == len(text) else _cells(text)
        before, cells = max(0, -x), cells[: max(0, self.width - x)]
        cells = cells[before:]
        x += before
        if cells and cells[0] == "":
            cells[0] = " "
        if cells and cell_len(cells[-1]) > 1:
            cells[-1] = " "
        self._characters[y][x : x + len(cells)] = cells
        self._styles[y][x : x + len(cells)] = [style] * len(cells)

    def put_cells(self, x: int, y: int, characters: str, styles: Sequence[Style]) -> None:
        """Write one-cell ``characters``, each in its own style."""
        if inside := self._inside(x, y, len(characters)):
            there, part = slice(inside.start, inside.stop), slice(inside.start - x, inside.stop - x)
            self._characters[y][there], self._styles[y][there] = characters[part], styles[part]

    def is_blank(self, x: int, y: int, length: int) -> bool:
        """Return whether cells are inside and blank."""
        return (
            len(self._inside(x, y, length)) == length
            and self._characters[y][x : x + length] == [" "] * length
        )

    def at(self, x: int, y: int) -> str:
        """Return the character here, which must be inside."""
        return self._characters[y][x]

    def put_over(self, x: int, y: int, text: str, style: Style) -> None:
        """Write one-cell characters, and add ``style`` to the cells' styles."""
        for place in self._inside(x, y, len(text)):
            self.put(place, y, text[place - x], self._styles[y][place] + style)

    def put_where_blank(self, x: int, y: int, text: str, style: Style) -> None:
        """Write one-cell characters, but only over blanks."""
        for place in self._inside(x, y, len(text)):
            if self._characters[y][place] == " ":
                self._characters[y][place], self._styles[y][place] = text[place - x], style

    def restyle(self, x: int, y: int, length: int, style: Style) -> None:
        """Add ``style`` to ``length`` cells."""
        for place in self._inside(x, y, length):
            self._styles[y][place] += style

    def _inside(self, x: int, y: int, length: int) -> range:
        return range(max(0, x), min(x + length, self.width) if 0 <= y < self.height else max(0, x))

    def strips(self) -> list[Strip]:
        """Return the rows, a segment per style."""
        strips = []
        for characters, styles in zip(self._characters, self._styles, strict=True):
            segments, x = [], 0
            for style, run in groupby(styles):
                end = x + len(list(run))
                segments.append(Segment("".join(characters[x:end]), style))
                x = end
            strips.append(Strip(segments, self.width))
        return strips


def _cells(text: str) -> list[str]:
    cells: list[str] = []
    for character in text:
        width = cell_len(character)
        if width == 0 and cells:
            cells[-1] += character
        elif width:
            cells += [character, ""][:width]
    return cells


Drawn = list[list[Segment]]  # rows of a piece of a picture


def strips_of_row(cells: Sequence[Drawn], width: int, style: Style) -> tuple[Strip, ...]:
    """Join the strips of a row."""
    strips = []
    for lines in zip(*cells, strict=True):
        inside = list(chain.from_iterable(lines))
        taken = sum(len(each.text) for each in inside)
        after = [Segment(" " * (width - taken), style)] if taken < width else []
        strip = Strip(_joined([*inside, *after]), max(taken, width))
        strips.append(strip if taken <= width else strip.adjust_cell_length(width, style))
    return tuple(strips)


def _joined(segments: Iterable[Segment]) -> Iterator[Segment]:
    for _, own in groupby(segments, key=lambda each: id(each.style)):
        found = list(own)
        yield found[0] if len(found) == 1 else Segment("".join(each.text for each in found), found[0].style)


def shortened(text: str, width: int, ellipsis: str) -> str:
    """Cut ``text`` with an ``ellipsis``."""
    if cell_len(text) <= width:
        return text
    room = width - cell_len(ellipsis)
    while text and cell_len(text) > room:
        text = text[:-1]
    return text.rstrip() + ellipsis if room >= 0 else ""


def centred(text: str, width: int) -> str:
    """Centre ``text``, rather left than right."""
    before = max(0, width - len(text)) // 2
    return (" " * before + text).ljust(width)


# Lines of styled pieces


KEPT_BLANK: Final = "\x1f"  # a blank in texts to be wrapped at which no line ends


def kept(text: str) -> str:
    """Keep ``text`` on one line in :func:`wrapped`."""
    return text.replace(" ", KEPT_BLANK)


@dataclass(frozen=True, slots=True)
class Piece:
    """A text that is shown whole or not."""

    text: str
    style: Style


Line = Sequence[Piece]


def spelled(line: Line, look: Look) -> list[Piece]:
    """Write ``line`` in the terminal's characters."""
    if look.glyphs.name != "ascii":
        return list(line)
    return [Piece(look.glyphs.spelled(piece.text), piece.style) for piece in line]


def length(line: Line) -> int:
    """Measure ``line`` in cells."""
    return sum(cell_len(piece.text) for piece in line)


def fitted(line: Line, width: int, look: Look) -> list[Piece]:
    """Return the leading pieces that fit."""
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
    """Return the first fitting form, else the last."""
    form: Line = ()
    for form in forms:
        if length(spelled(form, look)) <= width:
            break
    return form


def strips_of(lines: Sequence[Line], width: int, height: int, look: Look) -> list[Strip]:
    """Return ``height`` lines, padded with blank ones."""
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
    """Wrap ``text`` after ``first`` or ``rest``."""
    lines: list[str] = []
    current = first
    is_begun = False
    for word in look.glyphs.spelled(text).split(" "):
        shown = word.replace(KEPT_BLANK, " ")
        candidate = f"{current} {shown}" if is_begun else current + shown
        if is_begun and cell_len(candidate) > width:
            lines.append(current)
            candidate = rest + shown
        current, is_begun = candidate, True
    return [[Piece(line, style)] for line in (*lines, current)]
