"""What a program writes on its stdout or stderr, cut into lines, however much it is."""

from __future__ import annotations

import re
from collections import deque
from collections.abc import Iterator
from typing import Final, NamedTuple

from rl_tui.common.findings import printable

LONGEST_LINE: Final = 500
"""Characters of a line that are kept."""
MOST_A_SECOND: Final = 300
"""Lines of one second that are kept; of the others only the last ones."""
LAST_KEPT: Final = 20
"""How many of the last ones are kept where there are more."""

_LONGEST_RAW: Final = 4 * LONGEST_LINE  # bytes: a character has at most so many
# What moves a cursor or sets colours: CSI and OSC sequences, and others of two characters
_ESCAPES: Final = re.compile(r"\x1b(?:\[[0-?]*[ -/]*[@-~]|\][^\x07\x1b]*(?:\x07|\x1b\\)?|[@-Z\\-_])")


class WrittenLine(NamedTuple):
    """One line; one that it ``replaces`` was its beginning, or an earlier state of it."""

    text: str
    replaces: bool


class WrittenLines:
    """The lines of one stream, put together from pieces of any size, in bounded memory.

    A carriage return begins its line anew, as progress bars do it. A line without an end is told as it
    is, and again as it goes on.
    """

    def __init__(self) -> None:
        self._rest = b""
        self._is_begun = False  # the beginning of the line that has no end yet
        self._second = -1
        self._room = MOST_A_SECOND
        self._left_out = 0
        self._last: deque[bytes] = deque(maxlen=LAST_KEPT)

    def take(self, piece: bytes, now: float) -> Iterator[WrittenLine]:
        """Yield the lines that are known with ``piece``, which came at ``now``, in seconds on any clock."""
        if int(now) != self._second:
            yield from self._catch_up()
            self._second, self._room = int(now), MOST_A_SECOND
        *lines, rest = (self._rest + piece).split(b"\n", self._room)
        for line in lines:
            yield self._written(line)
        self._room -= len(lines)
        self._rest = _shortened(self._without_flood(rest))
        if self._room and self._rest.strip():
            text, replaces = self._written(self._rest)
            self._is_begun = True
            yield WrittenLine(text, replaces)

    def end(self) -> Iterator[WrittenLine]:
        """Yield what is left when nothing more will come."""
        yield from self._catch_up()
        if self._rest.strip() and not self._is_begun:
            yield self._written(self._rest)

    def _without_flood(self, text: bytes) -> bytes:
        """Count the whole lines of ``text``, keep the last ones, and return the one without an end."""
        *flood, rest = text.rsplit(b"\n", LAST_KEPT + 1)
        if flood:
            self._left_out += text.count(b"\n")
            self._last.extend(flood[-LAST_KEPT:])
            self._is_begun = False
        return rest

    def _catch_up(self) -> Iterator[WrittenLine]:
        """Yield how many lines were left out, and the last ones of them."""
        left_out = self._left_out - len(self._last)
        if left_out > 0:
            yield WrittenLine(f"… {left_out:,} lines left out", False)
        for line in self._last:
            yield WrittenLine(_text_of(line), False)
        self._last.clear()
        self._left_out = 0

    def _written(self, line: bytes) -> WrittenLine:
        replaces, self._is_begun = self._is_begun, False
        return WrittenLine(_text_of(line), replaces)


def _shortened(line: bytes) -> bytes:
    """Return as much of a line without an end as its text needs, and what tells that it was longer."""
    if len(line) > _LONGEST_RAW:
        line = line[line.rfind(b"\r", 0, len(line) - 1) + 1 :]
    return line[: _LONGEST_RAW + 1]


def _text_of(line: bytes) -> str:
    """Return what a terminal would show of ``line``, as harmless characters."""
    line = line.rstrip(b"\r")
    shown = line[line.rfind(b"\r") + 1 :][: _LONGEST_RAW + 1].decode("utf-8", "replace")
    text = printable(_ESCAPES.sub("", shown).expandtabs(8)).rstrip()
    return text if len(text) <= LONGEST_LINE else text[: LONGEST_LINE - 1] + "…"
