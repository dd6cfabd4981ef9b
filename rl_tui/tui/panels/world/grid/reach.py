"""Which cells of a map the agent can never be in."""

from __future__ import annotations

import numpy as np

from rl_tui.worlds.drawing import CellKind, Grid
from rl_tui.worlds.mdp.space import FiniteSpace
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP


def unreached_cells(space: FiniteSpace, grid: Grid) -> frozenset[int]:
    """Return the cells with a state, cliffs left out, that no way leads to from any start.

    None where it is not known what the actions lead to. Into a cliff the agent steps, but it is put back at
    once.
    """
    if not isinstance(space, TabularMDP):
        return frozenset()
    # what cannot be reached has no pairs, and so leads nowhere
    reached = np.diff(space.first_pair) > 0
    reached[space.next_state] = True
    reached[space.start_state] = True
    cells = np.array(grid.cell_of_state, dtype=np.int64)
    missed = set(cells[~reached].tolist())
    if missed:
        missed -= set(cells[reached].tolist())
    return frozenset(cell for cell in missed if grid.kinds[cell] is not CellKind.CLIFF)
