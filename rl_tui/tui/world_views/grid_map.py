"""What stands in each cell of a map at one moment of a run."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rl_tui.lab.snapshot import Snapshot
from rl_tui.worlds.drawing import CellKind, Grid
from rl_tui.worlds.space import FiniteSpace

NO_STATE = -1


@dataclass(frozen=True, slots=True)
class CellContent:
    """One cell.

    ``value`` is V(s) = max over a of Q(s, a), None where nothing can be done. ``known`` says that something
    was learned about the state: it was updated or its estimates differ. ``greedy`` holds the greedy actions,
    all ties, as their direction or the first letter of their name; it is empty where nothing is known.
    """

    kind: CellKind
    agent: bool
    value: float | None = None
    known: bool = False
    greedy: tuple[tuple[int, int] | str, ...] = ()


class GridMap:
    """A map and its states. Reading a cell costs the same in a map of any size."""

    def __init__(self, space: FiniteSpace, grid: Grid) -> None:
        self.grid = grid
        self._mdp = space
        self._signs = tuple(
            step if step and 0 in step and any(step) else (name[:1] or "?")
            for step, name in zip(grid.directions, space.action_names, strict=True)
        )
        self._state_of_cell = np.full(grid.rows * grid.columns, NO_STATE, dtype=np.int64)
        # backwards, so that the first of several states in one cell stays
        self._state_of_cell[np.array(grid.cell_of_state)[::-1]] = np.arange(space.states)[::-1]

    def content(self, row: int, column: int, snapshot: Snapshot) -> CellContent:
        """Return what stands in a cell. Of several states there it is the agent's, else the first."""
        cell = row * self.grid.columns + column
        kind = self.grid.kinds[cell]
        agent = self.grid.cell_of_state[snapshot.state] == cell
        state = snapshot.state if agent else int(self._state_of_cell[cell])
        if state == NO_STATE:
            return CellContent(kind, agent)
        pairs = self._mdp.pairs_of(state)
        if not pairs:
            return CellContent(kind, agent)
        q = snapshot.q[pairs.start : pairs.stop].tolist()
        value = max(q)
        known = min(q) != value or bool(snapshot.visits[pairs.start : pairs.stop].any())
        if not known:
            return CellContent(kind, agent, value)
        greedy = tuple(
            self._signs[int(self._mdp.pair_action[pair])]
            for pair, each in zip(pairs, q, strict=True)
            if each == value
        )
        return CellContent(kind, agent, value, known, greedy)
