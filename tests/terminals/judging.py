"""What a screen of the playground has to be, whatever the terminal."""

from __future__ import annotations

import re
from typing import Final

PLAIN_STUDENT: Final = "A student's eve"
_TITLES: Final = ("World", "Q", "Return", "greedy")  # the curve's panel names its lines where it is low
_TITLES_WITH_ROOM: Final = ("World", "Q", "Return", "Controls", "Last step")
_ROOM: Final = (100, 36)
_ESCAPE_TEXT: Final = re.compile(r"\[[?<>]?\d+(?:;\d+)*[a-zA-Z$~]|\x1b|�")
_COLOURS: Final = re.compile(rb"\x1b\[([0-9;]*)m")
_LEFT_CORNERS, _RIGHT_CORNERS = "╭╔+", "╮╗+"


def check_playground(screen: str, size: tuple[int, int], step: int) -> None:
    """Raise where a screen of the student's playground is not as it has to be in a terminal of ``size``."""
    columns, rows = size
    lines = screen.splitlines()
    assert len(lines) == rows, screen
    assert max(map(len, lines)) <= columns, screen
    assert not _ESCAPE_TEXT.search(screen), screen
    assert lines[0].startswith(f" {PLAIN_STUDENT}"), screen
    assert re.search(rf"paused .* step +{step}$", lines[0]), screen
    assert lines[-1].rstrip().endswith("? help"), screen
    tops = "\n".join(line for line in lines if re.search(r"[╭+][─-] \w", line))
    for title in _TITLES_WITH_ROOM if columns >= _ROOM[0] and rows >= _ROOM[1] else _TITLES[:2]:
        assert re.search(rf"[╭+][─-] {title}\b", tops), screen
    assert any(re.search(rf"[╭+][─-] {title}\b", tops) for title in _TITLES[2:]), screen
    check_boxes(lines, columns)


def check_boxes(lines: list[str], columns: int) -> None:
    """Raise where the panel at the right edge is not closed in every row that it takes."""
    edge = [line.ljust(columns)[columns - 1] for line in lines]
    sides = [row for row, character in enumerate(edge) if character in "│|"]
    assert sides, "\n".join(lines)
    tops = [row for row, character in enumerate(edge) if character in "╮+"]
    assert tops[0] == sides[0] - 1, "\n".join(lines)
    inside = edge[sides[0] : sides[-1] + 1]
    assert set(inside) <= set("│|╮╯+"), "\n".join(lines)


def colour_kinds(written: bytes) -> set[str]:
    """Return which kinds of colour are asked for: 16, 256, truecolor."""
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
