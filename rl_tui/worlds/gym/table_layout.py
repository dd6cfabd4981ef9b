"""Where the states of a Gymnasium table lie on a grid, how its actions are called and where they slip."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from rl_tui.worlds.drawing import Axes, CellKind, Grid, Title
from rl_tui.worlds.mdp.tabular_mdp import UNKNOWN_ACTION

_LETTERS: Final = {b"S": CellKind.START, b"F": CellKind.FLOOR, b"H": CellKind.HOLE, b"G": CellKind.GOAL}

_STEPS: Final = {"left": (0, -1), "down": (1, 0), "right": (0, 1), "up": (-1, 0)}

# Gymnasium numbers its actions but names them only in its documentation. A class is known by its name, so
# that nothing of Gymnasium need be imported.
_CLIFF: Final = "CliffWalkingEnv"
_TAXI: Final = "TaxiEnv"
_ACTION_NAMES: Final = {
    "FrozenLakeEnv": ("left", "down", "right", "up"),
    _CLIFF: ("up", "right", "down", "left"),
}

# Taxi: a state is where the taxi is (5×5), where the passenger is (four places or the taxi) and where the
# passenger wants to go (four places); its number is ((row · 5 + column) · 5 + passenger) · 4 + destination.
# So the map is twenty maps of the town: a row of them for each place of the passenger, a column for each
# destination.
_TAXI_ACTIONS: Final = ("south", "north", "east", "west", "pickup", "dropoff")
_TAXI_STATES: Final = 500
_TAXI_DIRECTIONS: Final = ((1, 0), (-1, 0), (0, 1), (0, -1), None, None)
_TOWN: Final = 5  # rows and columns
_PITCH: Final = _TOWN + 1  # a line of wall keeps the towns apart
_DESTINATIONS: Final = ("R", "G", "Y", "B")
_PASSENGER: Final = (*_DESTINATIONS, "in")
_STOPS: Final = ((0, 0), (0, 4), (4, 0), (4, 3))
TAXI_SHAPE: Final = (len(_PASSENGER) * _PITCH - 1, len(_DESTINATIONS) * _PITCH - 1)
_TAXI_ROWS, _TAXI_COLUMNS = TAXI_SHAPE
TAXI_LEGEND: Final = "towns: passenger down, destination across"
TAXI_AXES: Final = Axes(
    ("",) * _TAXI_ROWS,
    ("",) * _TAXI_COLUMNS,
    tuple(
        Title(down * _PITCH - 1, across * _PITCH, _TOWN, f"{passenger}→{destination}")
        for down, passenger in enumerate(_PASSENGER)
        for across, destination in enumerate(_DESTINATIONS)
    ),
)


@dataclass(frozen=True, slots=True)
class Layout:
    """The grid of an environment and the names of its states and actions.

    ``compass`` says that the actions are directions in the order of a circle, and that a state's number is
    its cell.
    """

    grid: Grid
    state_names: tuple[str, ...]
    action_names: tuple[str, ...]
    compass: bool

    def happened(self, state: int, action: int, place: int, count: int, next_state: int) -> int:
        """Return the action that really happened in outcome ``place`` of the ``count`` that the table lists.

        On a compass Gymnasium lists the actions beside the meant one in the order a − 1, a, a + 1 (modulo 4),
        or the meant one alone; a step off the cliff leads back to the start. The answer is −1 where that does
        not explain ``next_state`` on this grid.
        """
        if not self.compass or count not in (1, 3):
            return UNKNOWN_ACTION
        candidate = action if count == 1 else (action + place - 1) % len(self.action_names)
        landing, kinds = self._landing(state, candidate), self.grid.kinds
        falls = kinds[landing] is CellKind.CLIFF and kinds[next_state] is CellKind.START
        return candidate if landing == next_state or falls else UNKNOWN_ACTION

    def _landing(self, state: int, action: int) -> int:
        """Return the cell that a step from ``state`` leads to on a compass, staying at the edge."""
        down, right = _STEPS[self.action_names[action]]
        row, column = divmod(state, self.grid.columns)
        row = min(max(row + down, 0), self.grid.rows - 1)
        column = min(max(column + right, 0), self.grid.columns - 1)
        return row * self.grid.columns + column


def layout_of(environment: Any, states: int, actions: int, start: Mapping[int, float]) -> Layout:
    """Return the layout of an unwrapped environment.

    States lie row by row in the environment's own map if it has one of ``states`` cells. Those of Taxi lie
    on the map of its twenty towns, all others in the squarest grid that holds them, where actions are no
    directions.
    """
    classes = [each.__name__ for each in type(environment).__mro__]
    if _TAXI in classes and (states, actions) == (_TAXI_STATES, len(_TAXI_ACTIONS)):
        return Layout(_taxi_grid(), _taxi_state_names(), _TAXI_ACTIONS, compass=False)
    numbers = tuple(str(state) for state in range(states))
    letters = getattr(environment, "desc", None)
    shape = getattr(letters if letters is not None else environment, "shape", None)
    names = next((_ACTION_NAMES[each] for each in classes if each in _ACTION_NAMES), ())
    if not isinstance(shape, tuple) or len(shape) != 2 or math.prod(shape) != states or len(names) != actions:
        columns = math.ceil(math.sqrt(states))
        shape, letters, names = (math.ceil(states / columns), columns), None, ()
    rows, columns = int(shape[0]), int(shape[1])
    if letters is not None:
        kinds = [_LETTERS.get(bytes(letter), CellKind.FLOOR) for letter in np.asarray(letters).ravel()]
    else:
        kinds = [CellKind.START if cell in start else CellKind.FLOOR for cell in range(rows * columns)]
        if names and _CLIFF in classes:
            kinds[-columns:] = [CellKind.START, *[CellKind.CLIFF] * (columns - 2), CellKind.GOAL]
    grid = Grid(
        rows=rows,
        columns=columns,
        kinds=tuple(kinds),
        cell_of_state=tuple(range(states)),
        directions=tuple(_STEPS[name] for name in names) or (None,) * actions,
    )
    return Layout(
        grid, numbers, names or tuple(str(action) for action in range(actions)), compass=bool(names)
    )


def _taxi_state_names() -> tuple[str, ...]:
    """Return the names: ``2,3 R→B`` has the taxi in row 2, column 3, the passenger at R and bound for B.

    ``in`` is a passenger in the taxi.
    """
    names = []
    for state in range(_TAXI_STATES):
        row, column, passenger, destination = _taxi_decoded(state)
        names.append(f"{row},{column} {_PASSENGER[passenger]}→{_DESTINATIONS[destination]}")
    return tuple(names)


def _taxi_grid() -> Grid:
    """Return the map of the twenty towns.

    The goal is drawn where a ride has ended: the passenger is where they wanted to go, and so is the taxi.
    The walls inside the town lie between cells and are not drawn.
    """
    kinds = [CellKind.WALL] * (_TAXI_ROWS * _TAXI_COLUMNS)
    cells = []
    for state in range(_TAXI_STATES):
        row, column, passenger, destination = _taxi_decoded(state)
        cell = (passenger * _PITCH + row) * _TAXI_COLUMNS + destination * _PITCH + column
        arrived = passenger == destination and (row, column) == _STOPS[destination]
        kinds[cell] = CellKind.GOAL if arrived else CellKind.FLOOR
        cells.append(cell)
    return Grid(
        rows=_TAXI_ROWS,
        columns=_TAXI_COLUMNS,
        kinds=tuple(kinds),
        cell_of_state=tuple(cells),
        directions=_TAXI_DIRECTIONS,
        legend=TAXI_LEGEND,
        axes=TAXI_AXES,
    )


def _taxi_decoded(state: int) -> tuple[int, int, int, int]:
    """Return row, column, passenger and destination."""
    rest, destination = divmod(state, len(_DESTINATIONS))
    rest, passenger = divmod(rest, len(_PASSENGER))
    row, column = divmod(rest, _TOWN)
    return row, column, passenger, destination
