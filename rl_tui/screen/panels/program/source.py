"""Lines of somebody's source as they are drawn: data, with nothing in it that a terminal might obey."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Final

from rich.cells import cell_len

from rl_tui.common.findings import printable
from rl_tui.screen.draw.canvas import Line, Piece, shortened
from rl_tui.screen.theme.look import Look

AROUND: Final = 2
"""How many lines are shown before the one that is meant, and behind it."""

_LONGEST: Final = 300  # characters of a line that are looked at
_TAB: Final = 4
_ROOMY: Final = 48  # columns
_MOST_ROWS: Final = 6  # of one line that is broken


def safe_line(text: str) -> str:
    """Return a line of a file, or one that a program wrote, with tabs as blanks and no control characters."""
    return printable(text[:_LONGEST].rstrip("\r\n").expandtabs(_TAB))


def broken(text: str, room: int, most: int) -> Iterator[str]:
    """Yield ``text`` in parts of at most ``room`` (at least 1) cells, at least one part, ``most`` at most.

    A part ends behind a blank, where there is one in its second half.
    """
    for _ in range(most):
        part = text
        while len(part) > 1 and cell_len(part) > room:
            part = part[: max(1, min(len(part) - 1, room))]
        blank = part.rfind(" ") + 1
        if len(part) < len(text) and blank > len(part) // 2:
            part = part[:blank]
        yield part
        text = text[len(part) :]
        if not text:
            return


def in_characters(text: str, look: Look) -> str:
    """Return code, or what a program wrote, in the characters that there are; it is not spelled out."""
    return text if look.glyphs.name != "ascii" else text.encode("ascii", "replace").decode("ascii")


def source_lines(source: Sequence[str], line: int, look: Look, width: int) -> list[Line]:
    """Return ``line`` (from 1) of ``source`` with those around it, numbered, the one meant marked and whole.

    What all of them are indented by is left out, and half of the rest where there is little room. Empty
    where there is no such line.
    """
    if not 1 <= line <= len(source):
        return []
    numbers = range(max(1, line - AROUND), min(len(source), line + AROUND) + 1)
    texts = {number: in_characters(safe_line(source[number - 1]), look) for number in numbers}
    common = min((_indent(text) for text in texts.values() if text), default=0)
    columns, lines = len(str(numbers[-1])), list[Line]()
    for number, text in texts.items():
        indent = max(0, _indent(text) - common)
        code = " " * (indent if width >= _ROOMY else indent // 2) + text.lstrip(" ")
        lines += _numbered(number, code, columns, look, width, is_meant=number == line)
    return lines


def _numbered(
    number: int, code: str, columns: int, look: Look, width: int, *, is_meant: bool
) -> Iterator[Line]:
    palette = look.palette
    head = f" {look.glyphs.cursor if is_meant else ' '} {number:>{columns}} "
    room = max(1, width - cell_len(head))
    if not is_meant:
        yield [Piece(head + shortened(code, room, look.glyphs.ellipsis), palette.dim)]
        return
    begins = " " * min(room // 2, _indent(code) + 2)
    for place, part in enumerate(broken(code, room, 1)):
        yield [Piece(head, palette.text), Piece(part, palette.strong)]
        rest = code[len(part) :]
        for more in broken(rest, room - len(begins), _MOST_ROWS - place) if rest else ():
            yield [Piece(" " * cell_len(head) + begins + more, palette.strong)]


def _indent(text: str) -> int:
    return len(text) - len(text.lstrip(" "))
