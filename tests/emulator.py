"""A terminal emulator for tests, on pyte's parser."""

from __future__ import annotations

import codecs
import re
from collections.abc import Callable
from typing import Any, Final

import pyte
from pyte.screens import Char
from wcwidth import wcwidth

# Most output is text and colours. Colours are taken out, because pyte reads sequences slowly. So are those
# that pyte 0.8.2 misreads: with <, = or > before their numbers or a character after them, the query of the
# keyboard protocol, and strings for the terminal
_TAKEN_OUT: Final = re.compile(
    r"\x1b(?:\[(?P<colours>[0-9;]*)m"
    r"|\[[<=>][0-?]*[ -/]*[@-~]|\[[0-?]*[ -/]+[@-~]|\[\?[0-9;]*u|[P_^X][^\x1b]*\x1b\\)"
)
_UNFINISHED: Final = re.compile(r"\x1b(?:\[[0-?]*[ -/]*|[\]P_^X][^\x07\x1b]*\x1b?)?\Z")
_MODE_QUESTION: Final = re.compile(r"\x1b\[\?(\d+)\$p")
_SYNCHRONISED: Final = 2026
_ALTERNATE: Final = 1049
_PRIVATE: Final = 5  # pyte shifts the number of a private mode by this many bits


class Emulator(pyte.Screen):
    """Shows its input on a screen; ``answer`` receives the replies of the terminal."""

    def __init__(
        self,
        columns: int,
        lines: int,
        answer: Callable[[str], None] = lambda _: None,
        *,
        tells_position: bool = True,
        synchronises: bool = True,
    ) -> None:
        self._cells: dict[Char, _Cells] = {}
        self._narrow: set[str] = set()
        self._coloured: dict[tuple[Char, str], Char] = {}
        self._rows: list[str] = []
        self._main: tuple[Any, Any] | None = None
        super().__init__(columns, lines)
        self._answer = answer
        self._tells_position = tells_position
        self._synchronises = synchronises
        self._stream = pyte.Stream(self)
        self._decoder = codecs.getincrementaldecoder("utf-8")("replace")
        self._rest = ""

    def feed(self, written: bytes) -> None:
        """Show ``written``. An unfinished sequence waits for its end."""
        text = self._rest + self._decoder.decode(written)
        unfinished = _UNFINISHED.search(text)
        end = unfinished.start() if unfinished else len(text)
        self._rest = text[end:]
        at = 0
        for sequence in _TAKEN_OUT.finditer(text, 0, end):
            if at < sequence.start():
                self._stream.feed(text[at : sequence.start()])
            if (colours := sequence["colours"]) is None:
                self._reply(sequence[0])
            else:
                self._colour(colours)
            at = sequence.end()
        self._stream.feed(text[at:end])

    @property
    def text(self) -> str:
        if len(self._rows) != self.lines:
            self._rows = [""] * self.lines
            self.dirty.update(range(self.lines))
        for row in self.dirty:
            if row < self.lines:
                line = self.buffer[row]
                self._rows[row] = "".join([line[x].data for x in range(self.columns)]).rstrip()
        self.dirty.clear()
        return "\n".join(self._rows)

    @property
    def is_whole(self) -> bool:
        """No synchronised frame is in progress."""
        return _SYNCHRONISED << _PRIVATE not in self.mode

    def cell(self, column: int, row: int) -> Char:
        return self.buffer[row][column]

    def draw(self, data: str) -> None:
        """Write ``data`` at the cursor like pyte, but faster for plain text."""
        cursor = self.cursor
        is_plain = data.isascii() or all(map(self._is_narrow, data))
        if not is_plain or cursor.x + len(data) > self.columns or pyte.modes.IRM in self.mode or self.charset:
            super().draw(data)
            return
        cells = self._cells.get(cursor.attrs)
        if cells is None:
            cells = self._cells[cursor.attrs] = _Cells(cursor.attrs)
        line = self.buffer[cursor.y]
        for x, character in enumerate(data, cursor.x):
            line[x] = cells[character]
        cursor.x += len(data)
        self.dirty.add(cursor.y)

    def set_mode(self, *modes: int, **options: Any) -> None:
        """Add the alternate screen, which pyte lacks."""
        super().set_mode(*modes, **options)
        if options.get("private") and _ALTERNATE in modes and self._main is None:
            self._main = (dict(self.buffer), (self.cursor.x, self.cursor.y))
            self.buffer.clear()
            self.dirty.update(range(self.lines))

    def reset_mode(self, *modes: int, **options: Any) -> None:
        super().reset_mode(*modes, **options)
        if options.get("private") and _ALTERNATE in modes and self._main is not None:
            self.buffer.clear()
            buffer, (x, y) = self._main
            self.buffer.update(buffer)
            self.cursor.x, self.cursor.y = min(x, self.columns - 1), min(y, self.lines - 1)
            self._main = None
            self.dirty.update(range(self.lines))

    def report_device_status(self, mode: int = 0, **options: Any) -> None:
        if self._tells_position or mode != 6:
            super().report_device_status(mode)

    def write_process_input(self, data: str) -> None:
        self._answer(data)

    def _colour(self, numbers: str) -> None:
        key = (self.cursor.attrs, numbers)
        if key not in self._coloured:
            self.select_graphic_rendition(*(int(number or 0) for number in numbers.split(";")))
            self._coloured[key] = self.cursor.attrs
        self.cursor.attrs = self._coloured[key]

    def _reply(self, foreign: str) -> None:
        question = _MODE_QUESTION.fullmatch(foreign)
        if question and int(question[1]) == _SYNCHRONISED and self._synchronises:
            self._answer(f"\x1b[?{_SYNCHRONISED};2$y")

    def _is_narrow(self, character: str) -> bool:
        if character in self._narrow:
            return True
        if wcwidth(character) == 1:
            self._narrow.add(character)
            return True
        return False


class _Cells(dict[str, Char]):
    def __init__(self, attributes: Char) -> None:
        self._attributes = attributes

    def __missing__(self, character: str) -> Char:
        cell = self[character] = self._attributes._replace(data=character)
        return cell
