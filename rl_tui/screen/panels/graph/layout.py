"""The layout of a graph for one panel size: the arrangement with the best places for labels."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import product
from typing import Final, NamedTuple

from rich.cells import cell_len

from rl_tui.screen.panels.graph import routing
from rl_tui.screen.panels.graph.labels import (
    EdgeLabel,
    LineOf,
    LineRun,
    Obstacles,
    WantedLabel,
    place_labels,
    runs_of,
)
from rl_tui.screen.panels.graph.shape import GraphAction, GraphBranch, GraphShape

# Arrangements of the boxes


_BOX_HEIGHTS: Final = (4, 5, 6)  # borders, name, value: taller boxes have more ports at the sides
_LEAST_INNER: Final = 6  # a value, or a mark before a name of five letters
_MOST_INNER: Final = 16
_ROOMY: Final = (4, 2, 1, 0)  # additional characters inside if they fit
_TALLEST: Final = 11  # rows of the tallest box
_WIDEST: Final = 23  # columns inside the widest box
_LEAST_GAP: Final = 4  # an edge with a fork and a head
_MOST_GAP: Final = 20
_LEAST_ROWS: Final = 1
_MOST_ROWS: Final = 6

Places = tuple[routing.Box, ...]


def places(shape: GraphShape, width: int, height: int) -> Iterator[Places]:
    """Yield arrangements, promising ones first."""
    columns = 1 + max(node.column for node in shape.nodes)
    rows = 1 + max(node.row for node in shape.nodes)
    lines = [_lines_between(shape, row) for row in range(rows - 1)]
    across, wants = _wants(shape, columns)
    lefts = [max(0, wants[0] - less) for less in (0, 1, 2)] + [0]
    grown = _height(shape, width, height), _inner(shape, width)
    choices = product(
        enumerate(dict.fromkeys((grown[0], *_BOX_HEIGHTS))),
        enumerate(_box_widths(shape, columns, grown[1])),
        enumerate(lefts),
        enumerate((wants[-1], 0)),
    )
    seen = set()
    # smallest deviation from the preferred choices first
    for (_, box_height), (_, widths), (_, left), (_, right) in sorted(
        choices, key=lambda choice: sum(index for index, _ in choice)
    ):
        tops = _tops(rows, height, box_height, lines)
        columns_at = _lefts(widths, width, across, [left, *wants[1:-1], right])
        if tops is None or columns_at is None or (box_height, *widths, *columns_at) in seen:
            continue
        seen.add((box_height, *widths, *columns_at))
        yield tuple(
            routing.Box(columns_at[node.column], tops[node.row], widths[node.column], box_height)
            for node in shape.nodes
        )


def _inner(shape: GraphShape, width: int) -> int:
    columns = 1 + max(node.column for node in shape.nodes)
    return min(_WIDEST, 2 * width // (3 * columns) - 2)


def _height(shape: GraphShape, width: int, height: int) -> int:
    rows = 1 + max(node.row for node in shape.nodes)
    between = sum(1 + _lines_between(shape, row) for row in range(rows))
    most = min(_TALLEST, 1 + _inner(shape, width) // 2)
    return max(_BOX_HEIGHTS[0], min(most, (height - between) // rows))


def _box_widths(shape: GraphShape, columns: int, grown: int) -> Iterator[list[int]]:
    names = [
        max((cell_len(node.name) for node in shape.nodes if node.column == column), default=0)
        for column in range(columns)
    ]
    inner = [min(_MOST_INNER, max(_LEAST_INNER, 1 + name)) for name in names]
    if grown > max(inner) + _ROOMY[0]:
        yield [grown + 2] * columns
    for more in _ROOMY:
        yield [max(inner) + more + 2] * columns
    yield [each + 2 for each in inner]


def _lefts(
    box_widths: Sequence[int], width: int, across: Sequence[bool], wants: Sequence[int]
) -> list[int] | None:
    """Return each column's left edge. Margins and gaps grow to their wanted width first."""
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
        more = max(0.0, min(max(_MOST_GAP, width // 4) - room[gap], free / (len(room) - gap)))
        room[gap] += more
        free -= more
    x, lefts = room[0] + free / 2, []
    for box_width, after in zip(box_widths, room[1:], strict=True):
        lefts.append(int(x))
        x += box_width + after
    return lefts


def _tops(rows: int, height: int, box_height: int, wants: Sequence[int]) -> list[int] | None:
    gaps = [_LEAST_ROWS] * (rows - 1)
    free = height - rows * box_height - sum(gaps)
    if free < 0:
        return None
    while free > 0 and any(gap < max(_MOST_ROWS, height // 4) for gap in gaps):
        # rows without enough lines for labels come first, then the narrowest
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
    between = [
        action
        for action in shape.actions
        for branch in action.branches
        if {shape.nodes[action.source].row, shape.nodes[branch.target].row} == {row, row + 1}
    ]
    return max((1 + len(_label(action).split()) // 2 for action in between), default=1)


def _wants(shape: GraphShape, columns: int) -> tuple[list[bool], list[int]]:
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
                side, words = first if first == 0 else first + 1, _label(action).split()
                broken = ((" ".join(words[:place]), " ".join(words[place:])) for place in range(len(words)))
                wants[side] = max(wants[side], min(max(map(len, lines)) for lines in broken))
    return across, wants


def _label(action: GraphAction) -> str:
    return " ".join([action.label, *(branch.label for branch in action.branches)])


# Lines and labels


_GOOD_ENOUGH: Final = 1.2  # cost per label at which the search stops
_WORK: Final = 60  # actions × arrangements to try for a better layout
_MOST_WORK: Final = 240  # the same for a first layout
_MOST_ACTIONS: Final = 20  # more lines cannot be followed by eye
_NARROWNESS: Final = 20.0  # divided by the box width: acceptable extra cost of labels for wider boxes
_HEIGHT: Final = 0.3  # cost per row of difference from the wanted box height
_SECOND_PORT: Final = 1.0
_BY_A_TAKEN_PORT: Final = 5.0
_LOOP_SIDE: Final = {routing.RIGHT: 0.0, routing.LEFT: 1.5, routing.UP: 2.0, routing.DOWN: 2.5}
_LOOP_WIDTH: Final = 4  # of a loop above or below a box


class Stroke(NamedTuple):
    """A line's cell, with the directions in which it leaves."""

    pair: int
    x: int
    y: int
    arms: tuple[int, ...]


class ArrowHead(NamedTuple):
    """The head of an arrow."""

    pair: int
    x: int
    y: int
    direction: int


class Fork(NamedTuple):
    """The cell where a line splits into outcomes."""

    pair: int
    x: int
    y: int


@dataclass(frozen=True, slots=True)
class GraphLayout:
    """A graph's fixed parts, ``boxes`` by state."""

    boxes: Places
    strokes: tuple[Stroke, ...]
    heads: tuple[ArrowHead, ...]
    forks: tuple[Fork, ...]
    labels: tuple[EdgeLabel, ...]


@lru_cache(maxsize=32)
def graph_layout(shape: GraphShape, width: int, height: int) -> GraphLayout | None:
    """Return the best layout, or None if some part does not fit."""
    distinct_places = len({(node.column, node.row) for node in shape.nodes})
    if distinct_places < len(shape.nodes) or len(shape.actions) > _MOST_ACTIONS:
        return None
    best: tuple[float, GraphLayout] | None = None
    for tried, boxes in enumerate(places(shape, width, height), start=1):
        drawing = _Drawing(shape, boxes, width, height)
        if drawing.complete():
            cost, layout = drawing.finished()
            if best is None or cost < best[0]:
                best = (cost, layout)
        work = tried * len(shape.actions)
        if work > _MOST_WORK or (best is not None and (work > _WORK or best[0] < _GOOD_ENOUGH)):
            break
    return best[1] if best is not None else None


class _Drawing:
    def __init__(self, shape: GraphShape, boxes: Places, width: int, height: int) -> None:
        self._shape, self._boxes = shape, boxes
        self._sheet = routing.RoutingSheet(width, height, {cell for box in boxes for cell in box.cells()})
        self._taken_ports: set[routing.Cell] = set()
        self._strokes: list[Stroke] = []
        self._heads: list[ArrowHead] = []
        self._forks: list[Fork] = []
        self._lines: dict[routing.Cell, set[LineOf]] = {}
        self._wanted: list[WantedLabel] = []
        self._labels: list[EdgeLabel] = []
        self._label_cost = self._route_cost = 0.0

    def complete(self) -> bool:
        for action in sorted(self._shape.actions, key=self._length):
            if not self._put_action(action):
                return False
        obstacles = Obstacles(self._sheet.width, self._sheet.height, self._sheet.solid, self._lines)
        self._labels, self._label_cost, lost = place_labels(obstacles, self._wanted)
        return lost == 0

    def finished(self) -> tuple[float, GraphLayout]:
        cost = self._label_cost / max(1, len(self._wanted)) + 0.001 * self._route_cost
        cost += _HEIGHT * abs(
            self._boxes[0].height - _height(self._shape, self._sheet.width, self._sheet.height)
        )
        cost += _NARROWNESS / min(box.width for box in self._boxes)
        layout = GraphLayout(
            self._boxes, tuple(self._strokes), tuple(self._heads), tuple(self._forks), tuple(self._labels)
        )
        return cost, layout

    def _length(self, action: GraphAction) -> tuple[bool, float]:
        main = self._branches(action)[0]
        source, target = self._shape.nodes[action.source], self._shape.nodes[main.target]
        distance = abs(source.column - target.column) + abs(source.row - target.row)
        return main.target == action.source, distance

    def _branches(self, action: GraphAction) -> list[GraphBranch]:
        return sorted(action.branches, key=lambda branch: branch.target == action.source)

    def _put_action(self, action: GraphAction) -> bool:
        main, *others = self._branches(action)
        if main.target == action.source:
            path = self._loop(action.source)
        else:
            path = routing.route(self._sheet, *self._ports(action, main.target))
        if path is None:
            return False
        self._enter((action.pair, 0), path)
        self._want((action.pair, 0), action.label, runs_of(path.cells, path.directions))
        index = self._fork_index(path) if others else None
        self._put_head(action.pair, path, index)
        if index is None:
            return not others
        fork = path.cells[index]
        self._sheet.bar(fork)
        self._forks.append(Fork(action.pair, *fork))
        rest = runs_of(path.cells[index + 1 :], path.directions[index + 1 :])
        self._want((action.pair, 0), main.label, rest, inline=True)
        starts = {routing.Port(fork, (path.directions[index] + turn) % 4): 0.0 for turn in (1, 3)}
        for number, branch in enumerate(others, start=1):
            side_path = routing.route(
                self._sheet, starts, self._ends(branch.target, self._centres(branch.target, None))
            )
            if side_path is None:
                return False
            self._enter((action.pair, number), side_path)
            self._put_head(action.pair, side_path)
            starts.pop(side_path.start)
            runs = runs_of(side_path.cells, side_path.directions)
            self._want((action.pair, number), branch.label, runs, inline=True)
        return True

    def _fork_index(self, path: routing.Route) -> int | None:
        wish = 1 if len(path.cells) < 9 else 2
        straight = [
            index
            for index, cell in enumerate(
                path.cells[:-1] if path.end.direction in routing.HORIZONTAL else path.cells
            )
            if path.arms(index)[0] == routing.reverse(path.arms(index)[1])
            and len(self._sheet.lines[cell]) == 2
        ]
        return min(straight, key=lambda each: abs(each - wish), default=None)

    def _want(self, line: LineOf, text: str, runs: tuple[LineRun, ...], inline: bool = False) -> None:
        if text:
            self._wanted.append(WantedLabel(line, text, runs, inline))

    def _enter(self, line: LineOf, path: routing.Route) -> None:
        pair, start, end = line[0], path.start, path.end
        self._route_cost += path.cost
        self._sheet.take(path)
        self._strokes.append(Stroke(pair, *start.cell, (start.direction,)))
        for index, cell in enumerate(path.cells):
            self._strokes.append(Stroke(pair, *cell, path.arms(index)))
            self._lines.setdefault(cell, set()).add(line)
        self._taken_ports |= {start.cell, end.cell}

    def _put_head(self, pair: int, path: routing.Route, fork: int | None = None) -> None:
        # before the box, or in its border where a short line forks
        head = path.end.cell if fork == len(path.cells) - 1 else path.cells[-1]
        self._heads.append(ArrowHead(pair, *head, path.end.direction))

    def _ports(
        self, action: GraphAction, target: int
    ) -> tuple[dict[routing.Port, float], dict[routing.Port, float]]:
        leaving = self._ends(action.source, self._centres(action.source, target, action))
        starts = {
            routing.Port(port.cell, routing.reverse(port.direction)): cost for port, cost in leaving.items()
        }
        return starts, self._ends(target, self._centres(target, action.source, action))

    def _loop(self, state: int) -> routing.Route | None:
        free, middle = self._ends(state, {}), self._boxes[state].x + self._boxes[state].width / 2
        loops: list[routing.Route] = []
        for end, cost in free.items():
            side = routing.reverse(end.direction)
            apart = (0, -1) if side in routing.HORIZONTAL else (-_LOOP_WIDTH, 0)
            cell = (end.cell[0] + apart[0], end.cell[1] + apart[1])
            if routing.Port(cell, end.direction) not in free:
                continue
            off = 0.0 if side in routing.HORIZONTAL else abs(cell[0] + _LOOP_WIDTH / 2 - middle)
            loop = routing.route(self._sheet, {routing.Port(cell, side): _LOOP_SIDE[side] + off}, {end: cost})
            loops += [loop] if loop else []
        return min(loops, key=lambda loop: loop.cost, default=None)

    def _ends(self, state: int, centres: dict[int, float]) -> dict[routing.Port, float]:
        box, ends = self._boxes[state], {}
        for side in (routing.UP, routing.RIGHT, routing.DOWN, routing.LEFT):
            for index, cell in enumerate(box.ports(side)):
                if cell in self._taken_ports:
                    continue
                cost = 0.0
                if side in routing.HORIZONTAL:
                    cost += _SECOND_PORT * index
                else:
                    cost += abs(cell[0] - centres.get(side, cell[0]))
                    cost += sum(
                        _BY_A_TAKEN_PORT / abs(off)
                        for off in (-2, -1, 1, 2)
                        if (cell[0] + off, cell[1]) in self._taken_ports
                    )
                ends[routing.Port(cell, routing.reverse(side))] = cost
        return ends

    def _centres(self, state: int, other: int | None, action: GraphAction | None = None) -> dict[int, float]:
        box = self._boxes[state]
        share = 0.5
        if other is not None and action is not None:
            nodes = self._shape.nodes
            between = [
                each
                for each in self._shape.actions
                if {each.source, self._branches(each)[0].target} == {state, other}
            ]
            # edges that go up or left come first
            between.sort(key=lambda each: (-nodes[each.source].row, -nodes[each.source].column))
            share = (between.index(action) + 1) / (len(between) + 1)
        return dict.fromkeys((routing.UP, routing.DOWN), box.x + round(share * (box.width - 1)))
