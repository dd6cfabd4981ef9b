"""Drawings of worlds as pure data, with one view on the screen per class."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import NamedTuple


class CellKind(StrEnum):
    """Kind of a grid cell, with its own symbol and colour."""

    FLOOR = "floor"
    START = "start"
    GOAL = "goal"
    HOLE = "hole"
    WALL = "wall"
    CLIFF = "cliff"


class Title(NamedTuple):
    """A text centred over `columns` of walls, from `column` on.

    `row` is −1 above the map. `brief` replaces a long text.
    """

    row: int
    column: int
    columns: int
    text: str
    brief: str = ""

    def is_over(self, column: int) -> bool:
        """Return True if the title covers `column`."""
        return self.column <= column < self.column + self.columns


@dataclass(frozen=True, slots=True)
class Axes:
    """Labels of the rows and columns of a grid.

    `titles` name parts between walls. `names` says what rows and columns mean. `is_upward`: values of rows
    grow upwards, and a body moves along the columns.
    """

    rows: tuple[str, ...]
    columns: tuple[str, ...]
    titles: tuple[Title, ...] = ()
    names: tuple[str, str] | None = None
    is_upward: bool = False


class BodyKind(StrEnum):
    """Kind of body whose poses are states."""

    CART_POLE = "cart pole"
    MOUNTAIN_CAR = "mountain car"


@dataclass(frozen=True, slots=True)
class Body:
    """A body with some numbers, each cut into bins.

    ``middles[i]`` are the middles of the bins of number i, NaN if unobserved. The last number changes
    fastest.
    """

    kind: BodyKind
    middles: tuple[tuple[float, ...], ...]

    def pose(self, state: int) -> tuple[float, ...]:
        """Return the middle of each number's bin."""
        numbers = []
        for middles in reversed(self.middles):
            state, place = divmod(state, len(middles))
            numbers.append(middles[place])
        return tuple(reversed(numbers))


@dataclass(frozen=True, slots=True)
class Grid:
    """A map of rows × columns cells.

    Args:
        kinds: Row by row, [rows · columns].
        cell_of_state: Row · columns + column, [S].
        directions: Step (rows down, columns right) of each action, or None, [A].
        legend: Meaning of rows and columns, if the grid is not a map to walk on.
        wind: Cells that the wind blows upwards in each column. Empty without wind.
        one_way: Cells that can be left in one direction only, with this step.
        axes: Labels of rows and columns, if they are numbers.
        body: Body that these numbers belong to.
        walls: Cells with a wall to their right.
        name_parts: Meaning of the parts of a state's name, from long to short, or empty.
        idle_cell: Cell of states that never occur, or None.
    """

    rows: int
    columns: int
    kinds: tuple[CellKind, ...]
    cell_of_state: tuple[int, ...]
    directions: tuple[tuple[int, int] | None, ...]
    legend: str = ""
    wind: tuple[int, ...] = ()
    one_way: tuple[tuple[int, tuple[int, int]], ...] = ()
    axes: Axes | None = None
    body: Body | None = None
    walls: tuple[int, ...] = ()
    name_parts: tuple[str, ...] = ()
    idle_cell: int | None = None


@dataclass(frozen=True, slots=True)
class Graph:
    """States as nodes. ``places[s]`` is (column, row) of state s, from 0.

    `chain` lists states from left to right, if each leads only to its neighbours.
    """

    places: tuple[tuple[int, int], ...]
    chain: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class Arms:
    """A bandit with one bar for each arm."""

    count: int


Drawing = Grid | Graph | Arms
