"""How a world is drawn, as pure data. The screen has one view for each kind."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import NamedTuple


class CellKind(StrEnum):
    """What a cell of a grid is, for its glyph and colour."""

    FLOOR = "floor"
    START = "start"
    GOAL = "goal"
    HOLE = "hole"
    WALL = "wall"
    CLIFF = "cliff"


class Title(NamedTuple):
    """A ``text`` in the middle of so many ``columns`` of walls, the first at ``row``, −1 above the map."""

    row: int
    column: int
    columns: int
    text: str

    def is_over(self, column: int) -> bool:
        """Return whether ``column`` is one of its own."""
        return self.column <= column < self.column + self.columns


@dataclass(frozen=True, slots=True)
class Axes:
    """The labels of all rows and columns of a grid, empty for those that have none.

    ``names`` are what rows and columns are, where that is known, ``titles`` those of parts between walls.
    """

    rows: tuple[str, ...]
    columns: tuple[str, ...]
    titles: tuple[Title, ...] = ()
    names: tuple[str, str] | None = None


class BodyKind(StrEnum):
    """A body that states are poses of."""

    CART_POLE = "cart pole"
    MOUNTAIN_CAR = "mountain car"


@dataclass(frozen=True, slots=True)
class Body:
    """A body, of whose numbers each state has a bin.

    ``middles[i]`` are the middles of the bins of number i, in units of the environment, NaN where it is not
    observed. States are all combinations, the last number running fastest.
    """

    kind: BodyKind
    middles: tuple[tuple[float, ...], ...]

    def pose(self, state: int) -> tuple[float, ...]:
        """Return the middle of the bin that ``state`` has of each number."""
        numbers = []
        for middles in reversed(self.middles):
            state, place = divmod(state, len(middles))
            numbers.append(middles[place])
        return tuple(reversed(numbers))


@dataclass(frozen=True, slots=True)
class Grid:
    """A map of rows × columns cells.

    ``kinds`` holds rows · columns cells, row by row. ``cell_of_state[s]`` is the cell (row · columns +
    column) where state s is drawn. ``directions[a]`` is the step (rows down, columns right) that action a
    means, or None where the action is not a direction. ``legend`` says in a line what rows and columns mean
    where the grid is no place to walk about in; empty where it is. ``wind`` says of each column how many
    cells it blows up, below 0 down; empty where there is none. ``one_way`` has the cells that are left in
    one direction only, each with its step. ``axes`` label rows and columns where these are numbers, ``body``
    is what has these numbers, if that is known.
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


@dataclass(frozen=True, slots=True)
class Graph:
    """States as nodes. ``places[s]`` is (column, row) of state s, whole numbers from 0, as in the file.

    ``chain`` has the states from left to right where each leads only to its neighbours; empty elsewhere.
    """

    places: tuple[tuple[int, int], ...]
    chain: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class Arms:
    """A bandit: a bar for each of ``count`` arms, the pairs of its only state."""

    count: int


Drawing = Grid | Graph | Arms
