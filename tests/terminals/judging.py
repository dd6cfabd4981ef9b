"""Requirements for a screen of the playground."""

from __future__ import annotations

import re
from typing import Final

PLAIN_STUDENT: Final = "A student's eve"
_TITLES: Final = ("Q",)
_TITLES_WITH_ROOM: Final = ("Q", "Return", "Agent", "Last step")
_ROOM: Final = (100, 36)
_ESCAPE_TEXT: Final = re.compile(r"\[[?<>]?\d+(?:;\d+)*[a-zA-Z$~]|\x1b|�")
_COLOURS: Final = re.compile(rb"\x1b\[([0-9;]*)m")


def check_playground(screen: str, size: tuple[int, int], step: int) -> None:
    columns, rows = size
    lines = screen.splitlines()
    assert len(lines) == rows, screen
    assert max(map(len, lines)) <= columns, screen
    assert not _ESCAPE_TEXT.search(screen), screen
    assert lines[0].lstrip().startswith(PLAIN_STUDENT), screen
    assert re.search(rf"paused .* step +{step} *$", lines[0]), screen
    assert lines[-1].rstrip().endswith("? keys"), screen
    for title in _TITLES_WITH_ROOM if columns >= _ROOM[0] and rows >= _ROOM[1] else _TITLES:
        assert re.search(rf"(^|  ){title}(  |$)", screen, re.MULTILINE), screen


def colour_kinds(written: bytes) -> set[str]:
    kinds = set()
    for numbers in _COLOURS.findall(written):
        left = [int(number or 0) for number in numbers.split(b";")]
        while left:
            number = left.pop(0)
            if number in (38, 48):
                kind = left.pop(0)
                kinds.add({5: "256", 2: "truecolor"}[kind])
                del left[: {5: 1, 2: 3}[kind]]
            elif (30 <= number <= 47 and number != 39) or 90 <= number <= 107:
                kinds.add("16")
    return kinds
