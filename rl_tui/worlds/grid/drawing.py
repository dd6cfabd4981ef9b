"""How a map of characters is drawn."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rl_tui.worlds.drawing import Grid
from rl_tui.worlds.grid.moves import STEPS
from rl_tui.worlds.grid.states import GridStates


def grid_drawing(states: GridStates, actions: Sequence[str]) -> Grid:
    """Return the drawing of a map on which ``actions`` are the names of what can be done."""
    rows, columns = states.map.codes.shape
    kinds = np.empty(len(states.map.entries), dtype=object)
    kinds[:] = [entry.kind for entry in states.map.entries]
    steps = [STEPS.get(name, (0, 0)) for name in actions]
    return Grid(
        rows=rows,
        columns=columns,
        kinds=tuple(kinds[states.map.codes.ravel()].tolist()),
        cell_of_state=tuple(states.numbers.tolist()),
        directions=tuple(step if any(step) else None for step in steps),
    )
