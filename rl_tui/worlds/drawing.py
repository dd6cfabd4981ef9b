"""Drawings of worlds as pure data. The screen has one view per class."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import NamedTuple


class CellKind(StrEnum):
    """Kind of a grid cell. It selects symbol and colour."""

    FLOOR = "floor"
    START = "start"
    GOAL = "goal"
    HOLE = "hole"
    WALL = "wall"
    CLIFF = "cliff"


class Title(NamedTuple):
    """A text centred over some columns of walls.

    `column` is the first of the `columns`; `row` is −1 above the map. `brief` replaces a text that is too
    long.
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
    """Labels of the rows and columns of a grid. A label may be empty.

    `titles` name parts between walls. `names` says what rows and columns mean, if known. `is_upward`: values
    of rows grow upwards, and a body moves along the columns.
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

    ``middles[i]`` holds the middle of each bin of number i, in units of the environment, or NaN for an
    unobserved one. States are all combinations of bins, and the last number changes fastest.
    """

    kind: BodyKind
    middles: tuple[tuple[float, ...], ...]

    def pose(self, state: int) -> tuple[float, ...]:
        """Return the middle of each number's bin in `state`."""
        numbers = []
        for middles in reversed(self.middles):
            state, place = divmod(state, len(middles))
            numbers.append(middles[place])
        return tuple(reversed(numbers))


@dataclass(frozen=True, slots=True)
class Grid:
    """A map of rows × columns cells.

    Args:
        rows: Number of rows.
        columns: Number of columns.
        kinds: Kind of each cell, row by row, [rows · columns].
        cell_of_state: Cell of each state, row · columns + column, [S].
        directions: Step (rows down, columns right) of each action, or None if it is not a direction, [A].
        legend: Meaning of rows and columns, if the grid is not a map to walk on.
        wind: Cells that the wind blows upwards in each column. Negative is down. Empty without wind.
        one_way: Cells that can be left in one direction only, each with its step.
        axes: Labels of rows and columns, if they are numbers.
        body: Body that these numbers belong to, if known.
        walls: Cells with a wall between them and their neighbour at the right.
        name_parts: Meaning of the parts of a state's name, in forms from long to short. Empty if unknown.
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


@dataclass(frozen=True, slots=True)
class Graph:
    """States as nodes. ``places[s]`` is (column, row) of state s, from 0.

    `chain` lists the states from left to right if each leads only to its neighbours, otherwise it is empty.
    """

    places: tuple[tuple[int, int], ...]
    chain: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class Arms:
    """A bandit: one bar for each of `count` arms."""

    count: int


Drawing = Grid | Graph | Arms
