"""Signs in quadrant blocks at any size, and numbers three rows high.

A sign is a predicate of x (right) and y (down), both from −1 to 1 in the largest centred square.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from functools import lru_cache
from typing import Final, Literal

Direction = tuple[int, int]  # rows down and columns right, −1, 0 or 1 each
Sign = Direction | str  # an arrow by its direction, or a letter
SignName = Literal["agent", "arrow", "ring", "square", "star"]
_Inside = Callable[[float, float], bool]
_Star = tuple[tuple[int, int], ...]

QUADRANTS: Final = " ▘▝▀▖▌▞▛▗▚▐▜▄▙▟█"  # by bits: upper left, upper right, lower left, lower right
_HALVES: Final = " ▀▄█"  # by bits: upper, lower
_PIXELS: Final = {  # five rows from above, three pixels each, as octal digits; a point is one pixel wide
    "0": "75557",
    "1": "62227",
    "2": "71747",
    "3": "71717",
    "4": "55711",
    "5": "74717",
    "6": "74757",
    "7": "71122",
    "8": "75757",
    "9": "75717",
    "−": "00700",
    ".": "00001",
    "<": "12421",
    ">": "42124",
}
_STARS: Final[
    tuple[_Star, ...]
] = (  # half rows from above: first and last filled half column, counted from the middle
    ((0, 1), (0, 2), (0, 3), (0, 10), (0, 8), (0, 6), (0, 6), (2, 7), (4, 8), (6, 8)),
    ((0, 1), (0, 1), (0, 2), (0, 8), (0, 5), (0, 3), (1, 4), (3, 5)),
    ((0, 1), (0, 2), (0, 6), (0, 4), (1, 4), (3, 5)),
)
_LEAST_BY_RULE: Final = 12  # columns of a star that needs no drawing
_POINTS: Final = 4
_LEAST_SHAFT: Final = 6  # rows; a shorter arrow is all head
_SHAFT: Final = 0.32


@lru_cache(1_024)
def block_sign(name: SignName, columns: int, rows: int, direction: Direction = (0, 0)) -> tuple[str, ...]:
    """Return a sign's rows. Arrows fill their size. Other signs are centred."""
    across, up = (columns / 2, rows) if name == "arrow" else (min(columns / 2, rows),) * 2
    inside = _shape(name, direction, rows)
    if name == "star" and columns < _LEAST_BY_RULE:
        inside = next((_drawn_star(each, across) for each in _STARS if _fits(each, columns, rows)), inside)
    points = [(point + 0.5) / (2 * _POINTS) for point in range(2 * _POINTS)]

    def holds(column: int, row: int, right: int, down: int) -> bool:
        hits = sum(
            inside((column + x - columns / 2) / across, (2 * (row + y) - rows) / up)
            for x in points[right * _POINTS :][:_POINTS]
            for y in points[down * _POINTS :][:_POINTS]
        )
        return 2 * hits >= _POINTS**2

    def character(column: int, row: int) -> str:
        quarters = ((0, 0), (1, 0), (0, 1), (1, 1))
        return QUADRANTS[sum(holds(column, row, *each) << bit for bit, each in enumerate(quarters))]

    return tuple("".join(character(column, row) for column in range(columns)) for row in range(rows))


@lru_cache(1_024)
def block_number(text: str) -> tuple[str, ...]:
    """Write a number in three rows, if possible."""
    head, point, tail = text.partition(".")
    if point and head.lstrip("−") == "0":
        text = f"{head[:-1]}.{tail}"
    if not text or not set(text) <= _PIXELS.keys():
        return ()

    def row(upper: int) -> str:
        pixels = [[f"{int(line):03b}" for line in (_PIXELS[each] + "0")[upper:][:2]] for each in text]
        drawn = [
            "".join(_HALVES[int(low + high, 2)] for high, low in zip(*two, strict=True)) for two in pixels
        ]
        return " ".join(one[-1] if sign == "." else one for one, sign in zip(drawn, text, strict=True))

    return row(0), row(2), row(4)


def block_numbers(texts: Iterable[str], width: int) -> dict[str, tuple[str, ...]]:
    """Write all numbers in blocks, or none."""
    found = {text: block_number(text) for text in texts}
    return found if all(0 < len("".join(rows[:1])) <= width for rows in found.values()) else {}


def sign_size(width: int, height: int) -> tuple[int, int]:
    """Return an arrow's columns and rows."""
    rows = 2 if height == 3 else 3 if height <= 6 else round(0.6 * height)
    rows = min(rows, (width - 3) // 2)
    return 2 * rows, rows


def _shape(name: SignName, direction: Direction, rows: int) -> _Inside:
    match name:
        case "arrow":
            return _arrow(*direction, rows)
        case "agent":
            return lambda x, y: x * x + y * y <= 1.0
        case "ring":
            return lambda x, y: 0.30 <= x * x + y * y <= 0.95
        case "square":
            return lambda x, y: max(abs(x), abs(y)) <= 0.55
        case "star":
            return _star


def _arrow(down: int, right: int, rows: int) -> _Inside:
    if down and right:
        return lambda x, y: x * right + y * down >= -0.05 and max(abs(x), abs(y)) <= 1.0

    def inside(x: float, y: float) -> bool:
        along, beside = x * right + y * down, abs(x * down) + abs(y * right)
        if rows < 3 and right and along < -0.75 and beside < 0.5:
            return False  # a notch, so that a low arrow does not look like a plug
        if rows < _LEAST_SHAFT:
            return abs(along) <= 1 and beside <= (1 - along) / 2 + (0.12 if rows < 3 else 0.06)
        if along < -0.1:
            return along >= -1 and beside <= _SHAFT
        return along <= 1 and beside <= 0.84 * (1 - along) / 1.1 + 0.03

    return inside


def _fits(star: _Star, columns: int, rows: int) -> bool:
    return len(star) <= 2 * rows - (rows > 3) and max(end for _, end in star) <= columns


def _drawn_star(star: _Star, unit: float) -> _Inside:
    def inside(x: float, y: float) -> bool:
        row = math.floor(unit * y + len(star) / 2)
        return 0 <= row < len(star) and star[row][0] <= 2 * unit * abs(x) < star[row][1]

    return inside


def _star(x: float, y: float) -> bool:
    fifth, inner, outer = 2 * math.pi / 5, 0.42, 1.05
    radius, angle = math.hypot(x, y + 0.05), math.atan2(x, -y - 0.05) % fifth
    angle = abs(angle - fifth / 2)  # measured from the notch between two tips
    tip_x, tip_y = outer * math.cos(fifth / 2), outer * math.sin(fifth / 2)
    from_notch = radius * math.cos(angle) - inner
    return (tip_x - inner) * radius * math.sin(angle) - tip_y * from_notch >= -1e-9
