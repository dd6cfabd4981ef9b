"""Lesson texts: paragraphs, bullets, **bold**, `code` and equations."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from typing import Final

from rich.cells import cell_len, chop_cells
from rich.style import Style

from rl_tui.screen.draw.canvas import Line, Piece
from rl_tui.screen.theme.glyphs import UNICODE
from rl_tui.screen.theme.look import Look

_BULLET: Final = re.compile(r"\s{0,3}[-*•]\s+")
_MARKED: Final = re.compile(r"\*\*(.+?)\*\*|`([^`]+)`")
_EQUATION: Final = "    "
_EQUATION_INDENT: Final = "  "
_TWO_KEYS: Final = 3  # characters, with the blank between them
_LEAST_INDENTED: Final = 12  # cells of an equation whose continuation lines are indented


def plain(text: str) -> str:
    """Remove marks and line breaks."""
    return " ".join(_MARKED.sub(lambda match: match[1] or match[2], text).split())


def prose_lines(text: str, width: int, look: Look, style: Style | None = None) -> list[Line]:
    """Wrap ``text``, with ``style`` for unmarked words."""
    style = style or look.palette.text
    lines: list[Line] = []
    for number, block in enumerate(_blocks(text)):
        is_list = _BULLET.match(block[0]) is not None
        if number and not (is_list and _is_item(lines)):
            lines.append([])
        if block[0].startswith(_EQUATION) and not is_list:
            lines += [line for row in block for line in _equation(row, width, look)]
            continue
        match = _BULLET.match(block[0])
        words = " ".join(row.strip() for row in block)
        if match is not None:
            mark = look.glyphs.spelled("– ")
            lines += _paragraph(words[2:].strip(), width, style, look, mark, " " * len(mark))
        else:
            lines += _paragraph(words, width, style, look, "", "")
    return lines


def _is_item(lines: Sequence[Line]) -> bool:
    return bool(lines) and bool(lines[-1]) and (lines[-1][0].text in ("– ", "- ", "  "))


def _blocks(text: str) -> Iterator[list[str]]:
    block: list[str] = []
    for row in text.replace("\t", "    ").splitlines():
        is_equation = row.startswith(_EQUATION) and _BULLET.match(row) is None
        begins = _BULLET.match(row) is not None or (
            bool(block) and is_equation is not block[0].startswith(_EQUATION)
        )
        if block and (begins or not row.strip()):
            yield block
            block = []
        if row.strip():
            block.append(row)
    if block:
        yield block


def _equation(row: str, width: int, look: Look) -> Iterator[Line]:
    spelled = look.glyphs.spelled(row.removeprefix(_EQUATION).rstrip())
    room = max(1, width - len(_EQUATION_INDENT))
    further = _EQUATION_INDENT if room >= _LEAST_INDENTED else ""
    start = 0  # after the indentation
    while cell_len(spelled) > room:
        cut = spelled.rfind(" ", start + 1, room + 1)
        head = spelled[:cut] if cut > 0 else _chopped(spelled, room)
        yield [Piece(_EQUATION_INDENT + head, look.palette.strong)]
        spelled, start = further + spelled[len(head) :].lstrip(), len(further)
    yield [Piece(_EQUATION_INDENT + spelled, look.palette.strong)]


def _paragraph(text: str, width: int, style: Style, look: Look, first: str, rest: str) -> Iterator[Line]:
    line: list[Piece] = [Piece(first, style)] if first else []
    used, is_begun = len(first), False
    for word in _words(text, style, look):
        length = sum(cell_len(piece.text) for piece in word)
        if is_begun and used + 1 + length > width:
            yield line
            line, used, is_begun = ([Piece(rest, style)] if rest else []), len(rest), False
        if is_begun:
            line.append(Piece(" ", style))
            used += 1
        for part in _pieces_that_fit(word, width - used, width - len(rest)):
            if part is None:
                yield line
                line, used = ([Piece(rest, style)] if rest else []), len(rest)
                continue
            line.append(part)
            used += cell_len(part.text)
        is_begun = True
    yield line


def _pieces_that_fit(word: Sequence[Piece], room: int, whole: int) -> Iterator[Piece | None]:
    """Yield the pieces of ``word``. None breaks a long word."""
    if sum(cell_len(piece.text) for piece in word) <= max(room, 1):
        yield from word
        return
    for piece in word:
        text = piece.text
        while cell_len(text) > max(1, room):
            head = _chopped(text, max(1, room))
            yield Piece(head, piece.style)
            yield None
            text, room = text[len(head) :], whole
        if text:
            yield Piece(text, piece.style)
            room -= cell_len(text)


def _chopped(text: str, room: int) -> str:
    return chop_cells(text, room)[0] or text[0]


def _words(text: str, style: Style, look: Look) -> Iterator[list[Piece]]:
    """Yield words in pieces of one style. A pair of keys (`w n`) is one word."""
    word: list[Piece] = []
    for run, run_style in _runs(text, style, look):
        is_keys = run_style == look.palette.press and len(run) == _TWO_KEYS
        spelled = look.glyphs.spelled(run)
        for number, part in enumerate([spelled] if is_keys else re.split(r"\s+", spelled)):
            if number and word:
                yield word
                word = []
            if part:
                word.append(Piece(part, run_style))
    if word:
        yield word


def _runs(text: str, style: Style, look: Look) -> Iterator[tuple[str, Style]]:
    end = 0
    for match in _MARKED.finditer(text):
        yield text[end : match.start()], style
        if match[1] is not None:
            yield match[1], look.palette.strong
        else:
            yield match[2], look.palette.goal if match[2] == UNICODE.goal else look.palette.press
        end = match.end()
    yield text[end:], style
