"""Where the states of a Gymnasium table lie on a grid, how its actions are called and where they slip."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from rl_tui.worlds.drawing import CellKind, Grid
from rl_tui.worlds.gym.tables import taxi_layout
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
        or the meant one alone. The answer is −1 where that does not explain ``next_state`` on this grid.
        """
        if not self.compass:
            return UNKNOWN_ACTION
        if count == 1:
            candidate = action
        elif count == 3:
            candidate = (action + place - 1) % len(self.action_names)
        else:
            return UNKNOWN_ACTION
        return candidate if self._landing(state, candidate) == next_state else UNKNOWN_ACTION

    def _landing(self, state: int, action: int) -> int | None:
        """Return the cell that a step from ``state`` leads to, staying at the edge; None if no direction."""
        direction = self.grid.directions[action]
        if direction is None:
            return None
        row, column = divmod(state, self.grid.columns)
        row = min(max(row + direction[0], 0), self.grid.rows - 1)
        column = min(max(column + direction[1], 0), self.grid.columns - 1)
        return row * self.grid.columns + column


def layout_of(environment: Any, states: int, actions: int, start: Mapping[int, float]) -> Layout:
    """Return the layout of an unwrapped environment.

    States lie row by row in the environment's own map if it has one of ``states`` cells. Those of Taxi lie
    as ``taxi_layout`` says, all others in the squarest grid that holds them, where actions are no directions.
    """
    classes = [each.__name__ for each in type(environment).__mro__]
    if _TAXI in classes and (states, actions) == (taxi_layout.STATES, len(taxi_layout.ACTION_NAMES)):
        return Layout(
            taxi_layout.taxi_grid(), taxi_layout.state_names(), taxi_layout.ACTION_NAMES, compass=False
        )
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
