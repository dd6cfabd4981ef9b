"""Orthogonal routes between boxes, in character cells."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from heapq import heappop, heappush
from itertools import count
from typing import Final, NamedTuple

Cell = tuple[int, int]  # column, row

UP, RIGHT, DOWN, LEFT = range(4)
STEP: Final = ((0, -1), (1, 0), (0, 1), (-1, 0))
HORIZONTAL: Final = (RIGHT, LEFT)

# costs of a route besides its length: one row is about as long as two columns
_BEND: Final = 3.0
_CROSSING: Final = 12.0
_BESIDE_A_LINE: Final = 2.5
_BESIDE_A_BOX: Final = 0.7
_LENGTH: Final = (2.0, 1.0, 2.0, 1.0)
_TURNS: Final = tuple((ahead, (ahead + 1) % 4, (ahead + 3) % 4) for ahead in range(4))


def reverse(direction: int) -> int:
    """Return the opposite direction."""
    return (direction + 2) % 4


def next_cell(cell: Cell, direction: int) -> Cell:
    """Return the neighbour in ``direction``."""
    dx, dy = STEP[direction]
    return cell[0] + dx, cell[1] + dy


class Box(NamedTuple):
    """A rectangle, including its border."""

    x: int
    y: int
    width: int
    height: int

    def cells(self) -> Iterable[Cell]:
        """Return all cells."""
        return (
            (x, y) for y in range(self.y, self.y + self.height) for x in range(self.x, self.x + self.width)
        )

    def ports(self, side: int) -> list[Cell]:
        """Return a side's cells, away from corners."""
        if side in HORIZONTAL:
            x = self.x + self.width - 1 if side == RIGHT else self.x
            return [(x, y) for y in range(self.y + 1, self.y + self.height - 1)]
        y = self.y + self.height - 1 if side == DOWN else self.y
        return [(x, y) for x in range(self.x + 2, self.x + self.width - 2)]


class Port(NamedTuple):
    """A cell outside the box, and the direction of travel."""

    cell: Cell
    direction: int


class Route(NamedTuple):
    """Cells, and the direction of entry into each."""

    start: Port
    end: Port
    cells: tuple[Cell, ...]
    directions: tuple[int, ...]
    cost: float

    def arms(self, index: int) -> tuple[int, int]:
        """Return the line's directions in cell ``index``."""
        after = self.directions[index + 1] if index + 1 < len(self.cells) else self.end.direction
        return reverse(self.directions[index]), after


@dataclass
class RoutingSheet:
    """The occupied and barred cells."""

    width: int
    height: int
    solid: set[Cell] = field(default_factory=set)
    lines: dict[Cell, frozenset[int]] = field(default_factory=dict)
    barred: set[Cell] = field(default_factory=set)
    _entry_costs: tuple[dict[Cell, float], ...] = field(default_factory=lambda: ({}, {}, {}, {}))

    def take(self, route: Route) -> None:
        """Add ``route`` and bar its last cell."""
        for index, cell in enumerate(route.cells):
            arms = frozenset(route.arms(index))
            if cell in self.lines:
                arms |= self.lines[cell]
            self.lines[cell] = arms
        self.bar(route.cells[-1])

    def bar(self, cell: Cell) -> None:
        """Keep other lines out of ``cell``."""
        self.barred.add(cell)
        for costs in self._entry_costs:
            costs.clear()

    def entry_cost(self, cell: Cell, direction: int) -> float:
        """Return the cost of ``cell``, infinite if occupied."""
        known = self._entry_costs[direction]
        cost = known.get(cell)
        if cost is None:
            cost = known[cell] = self._entry_cost(cell, direction)
        return cost

    def _entry_cost(self, cell: Cell, direction: int) -> float:
        x, y = cell
        if not (0 <= x < self.width and 0 <= y < self.height) or cell in self.solid or cell in self.barred:
            return math.inf
        cost = _LENGTH[direction]
        if cell in self.lines:
            if self.lines[cell] != ({UP, DOWN} if direction in HORIZONTAL else {LEFT, RIGHT}):
                return math.inf
            cost += _CROSSING
        for side in _TURNS[direction][1:]:
            beside = next_cell(cell, side)
            if beside in self.lines:
                cost += _BESIDE_A_LINE
            elif beside in self.solid:
                cost += _BESIDE_A_BOX
        return cost


def route(sheet: RoutingSheet, starts: Mapping[Port, float], ends: Mapping[Port, float]) -> Route | None:
    """Return the cheapest route between ports with extra costs."""
    order = count()
    queue: list[tuple[float, int, Port, float]] = []
    came_from: dict[Port, Port] = {}
    best: dict[Port, float] = {}
    least_cost, lines = _least_cost_to(ends), sheet.lines

    def offer(at: Port, cost: float, before: Port) -> None:
        if cost < best.get(at, math.inf):
            best[at] = cost
            came_from[at] = before
            heappush(queue, (cost + least_cost(*at[0]), next(order), at, cost))

    for start, cost in starts.items():
        cell = next_cell(start.cell, start.direction)
        entry = sheet.entry_cost(cell, start.direction)
        if entry < math.inf:
            offer(Port(cell, start.direction), cost + entry, start)
    while queue:
        _, _, at, cost = heappop(queue)
        if cost > best[at]:
            continue
        if at in ends:
            return _traced(at, cost, came_from, starts)
        (x, y), direction = at
        on_a_line = (x, y) in lines
        for turn in (direction,) if on_a_line else _TURNS[direction]:
            dx, dy = STEP[turn]
            onward = (x + dx, y + dy)
            total = cost if turn == direction else cost + _BEND
            entry = sheet.entry_cost(onward, turn)
            if entry < math.inf:
                offer(Port(onward, turn), total + entry, at)
            elif not on_a_line and (turn == direction or turn not in HORIZONTAL):
                end = Port(onward, turn)
                if end in ends:
                    offer(end, total + ends[end], at)
    return None


def _least_cost_to(ends: Iterable[Port]) -> Callable[[int, int], float]:
    columns = [port.cell[0] for port in ends] or [0]
    rows = [port.cell[1] for port in ends] or [0]
    left, right, top, bottom = min(columns), max(columns), min(rows), max(rows)

    def least(x: int, y: int) -> float:
        across = left - x if x < left else x - right if x > right else 0
        down = top - y if y < top else y - bottom if y > bottom else 0
        # the last cell belongs to the box and costs nothing
        return max(0.0, across * _LENGTH[RIGHT] + (down - 1) * _LENGTH[DOWN])

    return least


def _traced(end: Port, cost: float, came_from: Mapping[Port, Port], starts: Mapping[Port, float]) -> Route:
    passed: list[Port] = []
    at = came_from[end]
    while at not in starts:
        passed.append(at)
        at = came_from[at]
    passed.reverse()
    return Route(at, end, tuple(each.cell for each in passed), tuple(each.direction for each in passed), cost)
