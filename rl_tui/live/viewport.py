"""The part of a large world copied for each frame."""

from __future__ import annotations

import mmap
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np
import numpy.typing as npt

from rl_tui.worlds.drawing import Grid
from rl_tui.worlds.mdp.space import BoolArray, FiniteSpace, FloatArray, IntArray
from rl_tui.worlds.world import World

if TYPE_CHECKING:
    from rl_tui.agents.last_step import LastStep
    from rl_tui.agents.learner_counters import Counters

NO_STATE: Final = -1


class Cells(NamedTuple):
    """A rectangle of cells of a map."""

    rows: int
    """Height in cells."""
    columns: int
    """Width in cells."""
    top: int | None = None
    """First row, from 0, or None to follow the agent."""
    left: int | None = None
    """First column, from 0, or None to follow the agent."""


class RowRange(NamedTuple):
    """Consecutive rows of a table by pairs."""

    pairs: int
    """Number of pairs."""
    first: int | None = None
    """First pair, or None to follow the agent."""


class Viewport(NamedTuple):
    """The visible part of a world."""

    cells: Cells | None = None
    """Visible part of the map, or None without a map."""
    rows: RowRange | None = None
    """Visible part of the table, or None without a table."""
    pair: int | None = None
    """A further pair that is shown."""


@dataclass(frozen=True, slots=True, eq=False)
class CopiedPart:
    """The copied part of Q and visits, meaningless zeros elsewhere."""

    q: FloatArray
    """Estimates, `[P]`."""
    visits: IntArray
    """Visits, `[P]`."""
    pairs: IntArray
    """Copied pairs, possibly repeated, `[K]`."""
    held: BoolArray
    """True for copied pairs, `[P]`."""


def first_state_of_cells(grid: Grid) -> IntArray:
    """Return the first state in each cell, `[rows, columns]`; `NO_STATE` in empty ones."""
    states = np.full(grid.rows * grid.columns, NO_STATE, dtype=np.int64)
    cells = np.array(grid.cell_of_state, dtype=np.int64)
    # in reverse order, so that the first state of a cell remains
    states[cells[::-1]] = np.arange(len(cells))[::-1]
    return states.reshape(grid.rows, grid.columns)


class PartCopier:
    """Copies the visible part of one world, at a cost that depends on its size only.

    A view that follows an agent contains it, so everything visible is closer to the agent than the size of
    the view.
    """

    def __init__(self, world: World) -> None:
        self.world = world
        self._space = world.space
        self._cells: IntArray | None = None
        if isinstance(world.drawing, Grid):
            self._cells = first_state_of_cells(world.drawing)
            self._cell_of_state = world.drawing.cell_of_state

    def copy(
        self, viewport: Viewport, agents: Iterable[Counters], q: FloatArray, visits: IntArray
    ) -> CopiedPart:
        """Copy `q` and `visits`, `[P]`, around each of `agents`, those of both visible runs."""
        pairs = np.concatenate([self._pairs_in(viewport, each.state, each.last_step) for each in agents])
        part = CopiedPart(
            _blank(len(q), np.float64), _blank(len(q), np.int64), pairs, _blank(len(q), np.bool_)
        )
        part.q[pairs] = q[pairs]
        part.visits[pairs] = visits[pairs]
        part.held[pairs] = True
        for array in (part.q, part.visits, part.held):
            array.flags.writeable = False
        return part

    def _pairs_in(self, viewport: Viewport, state: int, last: LastStep | None) -> IntArray:
        states = [np.array(self._met(viewport, state, last), dtype=np.int64)]
        if viewport.cells is not None:
            states += self._states_in(viewport.cells, state)
        parts = [pairs_of_states(self._space, np.concatenate(states))]
        if viewport.rows is not None:
            length, first = viewport.rows
            here = int(self._space.first_pair[followed_state(self._space, state, last)])
            parts.append(self._clipped(here - length, here + length + len(self._space.action_names)))
            if first is not None:
                parts.append(self._clipped(first, first + length))
        return np.concatenate(parts)

    def _met(self, viewport: Viewport, state: int, last: LastStep | None) -> list[int]:
        states = [state]
        if last is not None:
            states += [each for each in (last.state, last.next_state) if each != NO_STATE]
            if last.learned:
                states.append(self._space.state_of(last.updated_pair))
        # the request may refer to the previous world
        if viewport.pair is not None and viewport.pair < self._space.pairs:
            states.append(self._space.state_of(viewport.pair))
        return states

    def _states_in(self, cells: Cells, state: int) -> list[IntArray]:
        if self._cells is None:
            return []
        row, column = divmod(int(self._cell_of_state[state]), self._cells.shape[1])
        blocks = [
            self._cells[
                max(0, row - cells.rows) : row + cells.rows + 1,
                max(0, column - cells.columns) : column + cells.columns + 1,
            ]
        ]
        if cells.top is not None and cells.left is not None:
            top, left = cells.top, cells.left
            blocks.append(self._cells[top : top + cells.rows, left : left + cells.columns])
        return [block[block != NO_STATE] for block in blocks]

    def _clipped(self, first: int, last: int) -> IntArray:
        return np.arange(max(0, first), min(last, self._space.pairs), dtype=np.int64)


def followed_state(space: FiniteSpace, state: int, last: LastStep | None) -> int:
    """Return the state that a table follows: the agent's, or the last with a row."""
    return last.state if last is not None and not space.pairs_of(state) else state


def pairs_of_states(space: FiniteSpace, states: IntArray) -> IntArray:
    """Return all pairs of `states` in one array."""
    first = space.first_pair[states]
    count = space.first_pair[states + 1] - first
    before = np.cumsum(count) - count
    return np.asarray(np.repeat(first - before, count) + np.arange(int(count.sum())))


def _blank(length: int, kind: type[np.generic]) -> npt.NDArray[Any]:
    """Return zeros that take memory and time only where written. From the heap, numpy.zeros clears."""
    size = length * np.dtype(kind).itemsize
    if sys.platform == "win32":
        return np.frombuffer(mmap.mmap(-1, size), dtype=kind)
    return np.frombuffer(mmap.mmap(-1, size, flags=mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS), dtype=kind)
