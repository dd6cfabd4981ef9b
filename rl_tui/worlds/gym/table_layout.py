"""The grid of an environment with a transition table, and its names."""

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

# Gymnasium names its actions only in its documentation. A class is recognized by its name, so Gymnasium need
# not be imported
_CLIFF: Final = "CliffWalkingEnv"
_TAXI: Final = "TaxiEnv"
_ACTION_NAMES: Final = {
    "FrozenLakeEnv": ("left", "down", "right", "up"),
    _CLIFF: ("up", "right", "down", "left"),
}

# Taxi: a state is the place of the taxi (5×5), of the passenger (four stops or the taxi) and of the
# destination (four stops). Its number is ((row · 5 + column) · 5 + passenger) · 4 + destination. The map
# shows the town twenty times: one row per place of the passenger, one column per destination
_TAXI_ACTIONS: Final = ("south", "north", "east", "west", "pick up", "drop off")
_TAXI_STATES: Final = 500
_TAXI_DIRECTIONS: Final = ((1, 0), (-1, 0), (0, 1), (0, -1), None, None)
_TOWN: Final = 5  # rows and columns
_PITCH: Final = _TOWN + 1  # a wall separates the towns
_DESTINATIONS: Final = ("R", "G", "Y", "B")
_RIDES: Final = "in"
_PASSENGER: Final = (*_DESTINATIONS, _RIDES)
_STOPS: Final = ((0, 0), (0, 4), (4, 0), (4, 3))
TAXI_SHAPE: Final = (len(_PASSENGER) * _PITCH - 1, len(_DESTINATIONS) * _PITCH - 1)
_TAXI_ROWS, _TAXI_COLUMNS = TAXI_SHAPE
TAXI_LEGEND: Final = "towns: passenger down, destination across"
_TAXI_NAME_PARTS: Final = ("row,column passenger→destination", "row,col from→to", "r,c from→to", "r,c p→d")
TAXI_AXES: Final = Axes(
    ("",) * _TAXI_ROWS,
    ("",) * _TAXI_COLUMNS,
    tuple(
        Title(
            down * _PITCH - 1,
            across * _PITCH,
            _TOWN,
            f"{'in taxi' if passenger == _RIDES else f'at {passenger}'}, to {destination}",
            f"{passenger}→{destination}",
        )
        for down, passenger in enumerate(_PASSENGER)
        for across, destination in enumerate(_DESTINATIONS)
    ),
)


@dataclass(frozen=True, slots=True)
class Layout:
    """A grid with the names of states and actions.

    `compass`: actions are directions in circular order, and state numbers are cells.
    """

    grid: Grid
    state_names: tuple[str, ...]
    action_names: tuple[str, ...]
    compass: bool

    def happened(self, state: int, action: int, place: int, count: int, next_state: int) -> int:
        """Return the action that really happened in outcome `place` of `count`, or −1 if none fits.

        On a compass Gymnasium lists the outcomes in the order a − 1, a, a + 1 (modulo 4), or only a. A step
        off the cliff leads back to the start.
        """
        if not self.compass or count not in (1, 3):
            return UNKNOWN_ACTION
        candidate = action if count == 1 else (action + place - 1) % len(self.action_names)
        landing, kinds = self._landing(state, candidate), self.grid.kinds
        falls = kinds[landing] is CellKind.CLIFF and kinds[next_state] is CellKind.START
        return candidate if landing == next_state or falls else UNKNOWN_ACTION

    def _landing(self, state: int, action: int) -> int:
        down, right = _STEPS[self.action_names[action]]
        row, column = divmod(state, self.grid.columns)
        row = min(max(row + down, 0), self.grid.rows - 1)
        column = min(max(column + right, 0), self.grid.columns - 1)
        return row * self.grid.columns + column


def layout_of(environment: Any, states: int, actions: int, start: Mapping[int, float]) -> Layout:
    """Return the layout of an unwrapped environment.

    States lie on the environment's own map, if its size fits. Taxi has a map of twenty towns. All others get
    the squarest grid, without directions.
    """
    classes = [each.__name__ for each in type(environment).__mro__]
    if _TAXI in classes and (states, actions) == (_TAXI_STATES, len(_TAXI_ACTIONS)):
        return Layout(_taxi_grid(environment.desc), _taxi_state_names(), _TAXI_ACTIONS, compass=False)
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
    # Such as "2,3 R→B": taxi in row 2, column 3, passenger from R (or "in" it) to B
    names = []
    for state in range(_TAXI_STATES):
        row, column, passenger, destination = _taxi_decoded(state)
        names.append(f"{row},{column} {_PASSENGER[passenger]}→{_DESTINATIONS[destination]}")
    return tuple(names)


def _taxi_grid(town: np.ndarray) -> Grid:
    # In `town`, a bar between two places is a wall
    kinds = [CellKind.WALL] * (_TAXI_ROWS * _TAXI_COLUMNS)
    cells, walls = [], []
    for state in range(_TAXI_STATES):
        row, column, passenger, destination = _taxi_decoded(state)
        cell = (passenger * _PITCH + row) * _TAXI_COLUMNS + destination * _PITCH + column
        arrived = passenger == destination and (row, column) == _STOPS[destination]
        kinds[cell] = CellKind.GOAL if arrived else CellKind.FLOOR
        cells.append(cell)
        if column + 1 < _TOWN and town[1 + row, 2 + 2 * column] == b"|":
            walls.append(cell)
    return Grid(
        rows=_TAXI_ROWS,
        columns=_TAXI_COLUMNS,
        kinds=tuple(kinds),
        cell_of_state=tuple(cells),
        directions=_TAXI_DIRECTIONS,
        legend=TAXI_LEGEND,
        axes=TAXI_AXES,
        walls=tuple(walls),
        name_parts=_TAXI_NAME_PARTS,
    )


def _taxi_decoded(state: int) -> tuple[int, int, int, int]:
    rest, destination = divmod(state, len(_DESTINATIONS))
    rest, passenger = divmod(rest, len(_PASSENGER))
    row, column = divmod(rest, _TOWN)
    return row, column, passenger, destination
