"""Edge labels on free cells."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise
from typing import Final, NamedTuple

from rl_tui.screen.panels.graph.routing import HORIZONTAL, Cell

_FAR: Final = 2.5  # a blank line between line and label
_ANOTHER_LINE: Final = 1.2
_LEFT: Final = 0.4
_BELOW: Final = 0.3
_INLINE: Final = 0.0
_TOUCHES: Final = 1.0
_BY_ANOTHER_EDGE: Final = 2.5
_BY_ANOTHER_BRANCH: Final = 0.2

LineOf = tuple[int, int]  # pair, and index of its branch: the first one starts at the box


class EdgeLabel(NamedTuple):
    """One line of text for ``pair``."""

    pair: int
    x: int
    y: int
    text: str


Block = tuple[EdgeLabel, ...]


class LineRun(NamedTuple):
    """A straight part of an edge."""

    cells: tuple[Cell, ...]
    horizontal: bool


@dataclass(frozen=True, slots=True)
class WantedLabel:
    """A label along ``runs``, or on a short line if ``inline``."""

    line: LineOf
    text: str
    runs: tuple[LineRun, ...]
    inline: bool = False


@dataclass
class Obstacles:
    """Cells of boxes, and of lines with owners."""

    width: int
    height: int
    solid: set[Cell]
    lines: dict[Cell, set[LineOf]]


def runs_of(cells: Sequence[Cell], directions: Sequence[int]) -> tuple[LineRun, ...]:
    """Split a line into straight parts."""
    runs: list[LineRun] = []
    first = 0
    for index in range(1, len(cells) + 1):
        if index == len(cells) or directions[index] != directions[first]:
            # the cell of a bend belongs to both parts
            runs.append(LineRun(tuple(cells[max(0, first - 1) : index]), directions[first] in HORIZONTAL))
            first = index
    return tuple(runs)


def place_labels(obstacles: Obstacles, wanted: Iterable[WantedLabel]) -> tuple[list[EdgeLabel], float, int]:
    """Return labels, their cost, and the number left out."""
    choices = sorted(
        ((each, list(_choices(obstacles, each))) for each in wanted), key=lambda choice: len(choice[1])
    )
    tries = []
    for names_first in (True, False):
        choices.sort(key=lambda choice: choice[0].inline is names_first)
        tries.append(_placed(obstacles, choices))
    return min(tries, key=lambda each: (each[2], each[1]))


def _placed(
    obstacles: Obstacles, choices: Iterable[tuple[WantedLabel, list[tuple[float, Block]]]]
) -> tuple[list[EdgeLabel], float, int]:
    text: set[Cell] = set()
    placed: list[EdgeLabel] = []
    cost, lost = 0.0, 0
    for wanted, blocks in choices:
        best: tuple[float, Block] | None = None
        for block_cost, block in blocks:
            if best is not None and block_cost >= best[0]:
                continue
            extra = _surroundings(obstacles, text, wanted.line, block)
            if extra is not None and (best is None or block_cost + extra < best[0]):
                best = (block_cost + extra, block)
        if best is None:
            lost += 1
            continue
        cost += best[0]
        placed += best[1]
        for label in best[1]:
            text |= {(label.x + i, label.y) for i in range(len(label.text))}
    return placed, cost, lost


def _choices(obstacles: Obstacles, wanted: WantedLabel) -> Iterator[tuple[float, Block]]:
    for lines in _broken(wanted.text):
        for run in wanted.runs:
            blocks = _beside_horizontal(run, lines) if run.horizontal else _beside_vertical(run, lines)
            for cost, places in blocks:
                block = tuple(
                    EdgeLabel(wanted.line[0], x, y, text) for (x, y), text in zip(places, lines, strict=True)
                )
                if all(_is_free(obstacles, label) for label in block):
                    yield cost + _ANOTHER_LINE * (len(lines) - 1), block
            has_room = run.horizontal and len(run.cells) >= len(wanted.text) + 3
            if wanted.inline and has_room and len(lines) == 1:
                yield from _inline(obstacles, wanted, run)


def _broken(text: str) -> Iterator[list[str]]:
    words = text.split()
    for breaks in range(min(3, len(words))):
        for places in combinations(range(1, len(words)), breaks):
            bounds = [0, *places, len(words)]
            yield [" ".join(words[a:b]) for a, b in pairwise(bounds)]


def _beside_horizontal(run: LineRun, lines: list[str]) -> Iterator[tuple[float, list[Cell]]]:
    columns = sorted(x for x, _ in run.cells)
    y, middle, width = run.cells[0][1], (columns[0] + columns[-1]) / 2, max(map(len, lines))
    for x in range(columns[0] - width + 2, columns[-1]):
        off = 0.25 * abs(x + (width - 1) / 2 - middle)
        for far in (0, 1):
            for top, below in ((y - len(lines) - far, 0.0), (y + 1 + far, _BELOW)):
                cost = off + _FAR * far + below
                yield cost, [(x + (width - len(text)) // 2, top + i) for i, text in enumerate(lines)]


def _beside_vertical(run: LineRun, lines: list[str]) -> Iterator[tuple[float, list[Cell]]]:
    rows = sorted(y for _, y in run.cells)
    x, middle = run.cells[0][0], (rows[0] + rows[-1]) / 2
    for top in range(rows[0] - len(lines) + 1, rows[-1] + 1):
        off = 0.6 * abs(top + (len(lines) - 1) / 2 - middle)
        # a block that extends past the end of a line no longer seems to belong to it
        off += 1.0 * (max(0, rows[0] - top) + max(0, top + len(lines) - 1 - rows[-1]))
        for gap in (1, 2):
            cost = off + (0.8 if gap == 1 else 0.0)
            yield cost, [(x + gap, top + i) for i in range(len(lines))]
            yield cost + _LEFT, [(x - gap + 1 - len(text), top + i) for i, text in enumerate(lines)]


def _inline(obstacles: Obstacles, wanted: WantedLabel, run: LineRun) -> Iterator[tuple[float, Block]]:
    columns = sorted(x for x, _ in run.cells)
    y = run.cells[0][1]
    start = (columns[0] + columns[-1] + 1 - len(wanted.text)) // 2
    under = [(start + i, y) for i in range(len(wanted.text))]
    if all(obstacles.lines.get(cell) == {wanted.line} for cell in under):
        yield _INLINE, (EdgeLabel(wanted.line[0], start, y, wanted.text),)


def _is_free(obstacles: Obstacles, label: EdgeLabel) -> bool:
    is_inside = 0 <= label.x <= obstacles.width - len(label.text) and 0 <= label.y < obstacles.height
    if not is_inside:
        return False
    cells = [(label.x + i, label.y) for i in range(len(label.text))]
    return not any(cell in obstacles.solid or cell in obstacles.lines for cell in cells)


def _surroundings(obstacles: Obstacles, text: set[Cell], line: LineOf, block: Block) -> float | None:
    """Return the neighbours' cost, or None if the block touches ``text``."""
    cost = 0.0
    strangers: set[LineOf] = set()
    for label in block:
        y, end = label.y, label.x + len(label.text)
        if any((x, y) in text for x in range(label.x - 1, end + 1)):
            return None
        for side, beyond in ((label.x - 1, label.x - 2), (end, end + 1)):
            touched = (side, y) in obstacles.solid or obstacles.lines.get((side, y), {line}) != {line}
            if touched or (beyond, y) in text:
                cost += _TOUCHES
        near = [(x, y + dy) for x in range(label.x, end) for dy in (-1, 1)]
        near += [(x, y) for x in (label.x - 2, label.x - 1, end, end + 1)]
        for cell in near:
            strangers |= obstacles.lines.get(cell, set())
    branches = sum(1 for other in strangers if other[0] == line[0] and other != line)
    others = len({other[0] for other in strangers} - {line[0]})
    return cost + _BY_ANOTHER_BRANCH * branches + _BY_ANOTHER_EDGE * others
