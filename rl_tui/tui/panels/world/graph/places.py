"""Where the boxes of a graph stand: several ways to share out the room of a panel."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product
from typing import Final

from rich.cells import cell_len

from rl_tui.tui.panels.world.graph.routing import Box
from rl_tui.tui.panels.world.graph.shape import GraphAction, GraphShape

_BOX_HEIGHTS: Final = (4, 5, 6)  # borders, name, value; more where more lines need a place on the sides
_LEAST_INNER: Final = 6  # a value, and the mark before a name of five letters
_MOST_INNER: Final = 16
_ROOMY: Final = (4, 2, 0)  # more characters inside where there is room
_LEAST_GAP: Final = 4  # an edge with a fork and a head
_MOST_GAP: Final = 20
_LEAST_ROWS: Final = 1
_MOST_ROWS: Final = 6

Places = tuple[Box, ...]


def places(shape: GraphShape, width: int, height: int) -> Iterator[Places]:
    """Yield arrangements of one box a node within width × height, likely good ones first."""
    columns = 1 + max(node.column for node in shape.nodes)
    rows = 1 + max(node.row for node in shape.nodes)
    lines = [_lines_between(shape, row) for row in range(rows - 1)]
    across, wants = _wants(shape, columns)
    lefts = [max(0, wants[0] - less) for less in (0, 1, 2)] + [0]
    choices = product(
        enumerate(_BOX_HEIGHTS),
        enumerate(_box_widths(shape, columns)),
        enumerate(lefts),
        enumerate((wants[-1], 0)),
    )
    seen = set()
    # those that depart least from the first of every choice come first
    for (_, box_height), (_, widths), (_, left), (_, right) in sorted(
        choices, key=lambda choice: sum(index for index, _ in choice)
    ):
        tops = _tops(rows, height, box_height, lines)
        columns_at = _lefts(widths, width, across, [left, *wants[1:-1], right])
        if tops is None or columns_at is None or (box_height, *widths, *columns_at) in seen:
            continue
        seen.add((box_height, *widths, *columns_at))
        yield tuple(
            Box(columns_at[node.column], tops[node.row], widths[node.column], box_height)
            for node in shape.nodes
        )


def _box_widths(shape: GraphShape, columns: int) -> Iterator[list[int]]:
    """Yield the widths of the columns of boxes: roomy, compact, as narrow as their names."""
    names = [
        max((cell_len(node.name) for node in shape.nodes if node.column == column), default=0)
        for column in range(columns)
    ]
    inner = [min(_MOST_INNER, max(_LEAST_INNER, 1 + name)) for name in names]
    for more in _ROOMY:
        yield [max(inner) + more + 2] * columns
    yield [each + 2 for each in inner]


def _lefts(
    box_widths: Sequence[int], width: int, across: Sequence[bool], wants: Sequence[int]
) -> list[int] | None:
    """Return the first column of each column of boxes, None if they do not fit.

    ``wants`` are the characters for left margin, gaps and right margin. The margins get theirs, the gaps
    share what is left up to theirs, and what is then still left widens everything.
    """
    least = [_LEAST_GAP if crossed else 2 for crossed in across]
    room = [float(each) for each in (wants[0], *least, wants[-1])]
    free = width - sum(box_widths) - sum(room)
    if free < 0:
        return None
    missing = [max(0.0, want - has) for want, has in zip(wants, room, strict=True)]
    part = min(1.0, free / sum(missing)) if any(missing) else 0.0
    room = [has + part * more for has, more in zip(room, missing, strict=True)]
    free -= part * sum(missing)
    for gap in range(1, len(room) - 1):
        more = max(0.0, min(_MOST_GAP - room[gap], free / (len(room) - gap)))
        room[gap] += more
        free -= more
    x, lefts = room[0] + free / 2, []
    for box_width, after in zip(box_widths, room[1:], strict=True):
        lefts.append(int(x))
        x += box_width + after
    return lefts


def _tops(rows: int, height: int, box_height: int, wants: Sequence[int]) -> list[int] | None:
    """Return the first row of each row of boxes."""
    gaps = [_LEAST_ROWS] * (rows - 1)
    free = height - rows * box_height - sum(gaps)
    if free < 0:
        return None
    while free > 0 and any(gap < _MOST_ROWS for gap in gaps):
        # rows that still lack lines for labels come first, then the narrowest
        index = min(range(len(gaps)), key=lambda each: (gaps[each] >= wants[each], gaps[each]))
        if gaps[index] >= wants[index] and free <= 2:
            break
        gaps[index] += 1
        free -= 1
    y, tops = free // 2, []
    for gap in [*gaps, 0]:
        tops.append(y)
        y += box_height + gap
    return tops


def _lines_between(shape: GraphShape, row: int) -> int:
    """Return the lines that labels want between two rows of boxes."""
    between = [
        action
        for action in shape.actions
        for branch in action.branches
        if {shape.nodes[action.source].row, shape.nodes[branch.target].row} == {row, row + 1}
    ]
    return max((1 + len(_label(action).split()) // 2 for action in between), default=1)


def _wants(shape: GraphShape, columns: int) -> tuple[list[bool], list[int]]:
    """Return which gaps an edge crosses, and how wide left margin, gaps and right margin would like to be."""
    across = [False] * (columns - 1)
    wants = [0] * (columns + 1)
    for action in shape.actions:
        source = shape.nodes[action.source]
        for branch in action.branches:
            target = shape.nodes[branch.target]
            first, last = sorted((source.column, target.column))
            for gap in range(first, last):
                across[gap] = True
                wants[gap + 1] = max(wants[gap + 1], len(action.label) + 4)
            if branch.target == action.source:
                wants[first + 1] = max(wants[first + 1], len(branch.label or action.label) + 4)
            elif first == last:
                side = first if first == 0 else first + 1
                wants[side] = max(wants[side], _in_two_lines(_label(action)))
    return across, wants


def _in_two_lines(text: str) -> int:
    """Return the width of ``text`` broken once at the best blank."""
    words = text.split()
    return min(max(len(" ".join(words[:place])), len(" ".join(words[place:]))) for place in range(len(words)))


def _label(action: GraphAction) -> str:
    return " ".join([action.label, *(branch.label for branch in action.branches)])
