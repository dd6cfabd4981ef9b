"""A watched program's output."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import ClassVar, Final

from rich.cells import cell_len
from textual.binding import BindingType
from textual.strip import Strip

from rl_tui.common.findings import one_line, printable
from rl_tui.live.program_view import ProgramView
from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.draw.canvas import Line, Piece, shortened, strips_of, wrapped
from rl_tui.screen.kit.scrolling import ScrolledPanel, scroll_bindings
from rl_tui.screen.panels.program.words import LONGEST_NAME, LONGEST_SENTENCE, code_around, place_text
from rl_tui.screen.theme.look import Look

NOTHING_WRITTEN: Final = "your program has printed nothing yet: space runs it"
MOST_LINES: Final = 400

_MOST_ROWS: Final = 6  # of one wrapped line
_MOST_TRACEBACK: Final = 60  # lines
_LEAST_COLUMNS: Final = 10
_MOST_KEPT: Final = 2_048  # the same lines are drawn in every frame


class OutputPanel(ScrolledPanel):
    """Lines of output, the last visible until scrolled."""

    BINDINGS: ClassVar[list[BindingType]] = scroll_bindings("output")
    title = "Output"
    _follows = True

    def rows(self, snapshot: Snapshot | None, width: int, height: int) -> list[Strip]:
        """Return all rows, oldest line first."""
        program = None if snapshot is None else snapshot.program
        if program is None:
            return []
        shown = program.output[-MOST_LINES:]
        columns = len(f"{shown[-1].step:,}") if shown else 0
        rows = [
            row
            for line in shown
            for row in _line_rows(line.step, line.stream, line.text, columns, width, self.look)
        ]
        ending = _ending(program, self.look, width)
        if not rows and not ending:
            ending = [*wrapped(NOTHING_WRITTEN, width, self.look.palette.dim, self.look)]
        rows += strips_of(ending, width, len(ending), self.look)
        if self._follows:
            self._first = max(0, len(rows) - height)
        return rows

    def _scroll(self, rows: int) -> None:
        self._follows = False
        super()._scroll(rows)
        self._follows = self._first >= self._rows_in_all - self.size.height


@lru_cache(_MOST_KEPT)
def _line_rows(step: int, stream: str, text: str, columns: int, width: int, look: Look) -> tuple[Strip, ...]:
    palette = look.palette
    is_error = stream == "err"
    mark = "!" if is_error else look.glyphs.axis_vertical
    style = palette.bad if is_error else palette.text
    room = max(_LEAST_COLUMNS, width - columns - 4)
    lines: list[Line] = []
    for place, part in enumerate(broken(_in_characters(safe_line(text), look), room, _MOST_ROWS)):
        number = f"{step:,}" if place == 0 else ""
        head = [
            Piece(f" {number:>{columns}} ", palette.dim),
            Piece(f"{mark} ", style if is_error else palette.dim),
        ]
        lines.append([*head, Piece(part, style)])
    return tuple(strips_of(lines, width, len(lines), look))


def _ending(program: ProgramView, look: Look, width: int) -> list[Line]:
    palette, error = look.palette, program.error
    if error is None:
        text = f" {look.glyphs.stopped} your program has ended"
        return [[Piece(text, palette.strong)]] if program.ended else []
    lines: list[Line] = []
    room = max(_LEAST_COLUMNS, width - 1)
    for text in _calls(error.traceback):
        parts = broken(_in_characters(safe_line(text), look), room, _MOST_ROWS)
        lines += [[Piece(f" {part}", palette.dim)] for part in parts]
    place = place_text(error.file, error.line, program)
    what = f"{one_line(error.type, LONGEST_NAME)}: {one_line(error.text, LONGEST_SENTENCE)}"
    said = f"{look.glyphs.stopped} {what} ({place})" if place else f"{look.glyphs.stopped} {what}"
    lines += [
        [Piece(f" {part}", palette.bad)] for part in broken(_in_characters(said, look), room, _MOST_ROWS)
    ]
    return lines + source_lines(*code_around(error.file, error.line, program), look, width)


def _calls(traceback: str) -> Sequence[str]:
    lines = traceback.splitlines()[-_MOST_TRACEBACK:]
    return lines[:-1] if lines and not lines[-1].startswith(" ") else lines


# Source lines, without control characters


_AROUND: Final = 2  # lines on either side
_LONGEST: Final = 300  # characters of a line
_TAB: Final = 4
_ROOMY: Final = 48  # columns


def safe_line(text: str) -> str:
    """Remove tabs and control characters."""
    return printable(text[:_LONGEST].rstrip("\r\n").expandtabs(_TAB))


def broken(text: str, room: int, most: int) -> Iterator[str]:
    """Break ``text`` into 1 to ``most`` parts of ``room`` cells."""
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


def _in_characters(text: str, look: Look) -> str:
    return text if look.glyphs.name != "ascii" else text.encode("ascii", "replace").decode("ascii")


def source_lines(source: Sequence[str], line: int, look: Look, width: int) -> list[Line]:
    """Return ``line`` (from 1), marked, with its neighbours.

    Common indentation is removed. Narrow panels halve the rest.
    """
    if not 1 <= line <= len(source):
        return []
    numbers = range(max(1, line - _AROUND), min(len(source), line + _AROUND) + 1)
    texts = {number: _in_characters(safe_line(source[number - 1]), look) for number in numbers}
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
