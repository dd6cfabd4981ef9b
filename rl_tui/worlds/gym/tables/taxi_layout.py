"""How the 500 states of Gymnasium's Taxi lie on a map and what they are called.

A state is where the taxi is (5×5), where the passenger is (four places or the taxi) and where the passenger
wants to go (four places); its number is ((row · 5 + column) · 5 + passenger) · 4 + destination. So the map is
twenty maps of the town: one row of them for each place of the passenger, one column for each destination.
"""

from __future__ import annotations

from typing import Final

from rl_tui.worlds.drawing import CellKind, Grid

ACTION_NAMES: Final = ("south", "north", "east", "west", "pickup", "dropoff")
STATES: Final = 500

_DIRECTIONS: Final = ((1, 0), (-1, 0), (0, 1), (0, -1), None, None)
_TOWN: Final = 5  # rows and columns
_PITCH: Final = _TOWN + 1  # a line of wall keeps the towns apart
_DESTINATIONS: Final = ("R", "G", "Y", "B")
_PASSENGER: Final = (*_DESTINATIONS, "in")
_STOPS: Final = ((0, 0), (0, 4), (4, 0), (4, 3))

_ROWS: Final = len(_PASSENGER) * _PITCH - 1
_COLUMNS: Final = len(_DESTINATIONS) * _PITCH - 1


def state_names() -> tuple[str, ...]:
    """Return the names: ``2,3 R→B`` has the taxi in row 2, column 3, the passenger at R and bound for B.

    ``in`` is a passenger in the taxi.
    """
    names = []
    for state in range(STATES):
        row, column, passenger, destination = _decoded(state)
        names.append(f"{row},{column} {_PASSENGER[passenger]}→{_DESTINATIONS[destination]}")
    return tuple(names)


def taxi_grid() -> Grid:
    """Return the map of the twenty towns.

    The goal is drawn where a ride has ended: the passenger is where they wanted to go, and so is the taxi.
    The walls inside the town lie between cells and are not drawn.
    """
    kinds = [CellKind.WALL] * (_ROWS * _COLUMNS)
    cells = []
    for state in range(STATES):
        row, column, passenger, destination = _decoded(state)
        cell = (passenger * _PITCH + row) * _COLUMNS + destination * _PITCH + column
        arrived = passenger == destination and (row, column) == _STOPS[destination]
        kinds[cell] = CellKind.GOAL if arrived else CellKind.FLOOR
        cells.append(cell)
    return Grid(
        rows=_ROWS,
        columns=_COLUMNS,
        kinds=tuple(kinds),
        cell_of_state=tuple(cells),
        directions=_DIRECTIONS,
        legend="towns: passenger down, destination across",
    )


def _decoded(state: int) -> tuple[int, int, int, int]:
    """Return row, column, passenger and destination."""
    rest, destination = divmod(state, len(_DESTINATIONS))
    rest, passenger = divmod(rest, len(_PASSENGER))
    row, column = divmod(rest, _TOWN)
    return row, column, passenger, destination
