"""What a snapshot copies of a world too large to be copied whole for every frame."""

from __future__ import annotations

import mmap
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np
import numpy.typing as npt

from rl_tui.worlds.drawing import Grid
from rl_tui.worlds.mdp.space import BoolArray, FiniteSpace, FloatArray, IntArray
from rl_tui.worlds.world import World

if TYPE_CHECKING:
    from rl_tui.agents.last_step import LastStep

MOST_COPIED: Final = 100_000
NO_STATE: Final = -1


class Cells(NamedTuple):
    """``rows`` × ``columns`` cells of a map, from (top, left) on; both None: wherever the agent is."""

    rows: int
    columns: int
    top: int | None = None
    left: int | None = None


class Stretch(NamedTuple):
    """So many ``pairs`` in a row, from ``first`` on; None: wherever the agent is."""

    pairs: int
    first: int | None = None


class Sight(NamedTuple):
    """What a screen shows: a part of the map, a part of the table, and one ``pair`` by itself."""

    cells: Cells | None = None
    stretch: Stretch | None = None
    pair: int | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Window:
    """The parts of Q and visits that were copied; everywhere else both are 0 and mean nothing.

    ``pairs``, [K], are the pairs that were copied, some more than once; ``held``, [P], marks them.
    """

    q: FloatArray
    visits: IntArray
    pairs: IntArray
    held: BoolArray


def is_large(world: World) -> bool:
    """Tell whether to copy all of Q and visits for each frame would be felt.

    Only maps are shown in parts: other drawings show every state.
    """
    return world.space.pairs > MOST_COPIED and isinstance(world.drawing, Grid)


def first_state_of_cells(grid: Grid) -> IntArray:
    """Return the first state that is drawn in each cell, [rows, columns]; ``NO_STATE`` where none is."""
    states = np.full(grid.rows * grid.columns, NO_STATE, dtype=np.int64)
    cells = np.array(grid.cell_of_state, dtype=np.int64)
    # backwards, so that the first of several states in one cell stays
    states[cells[::-1]] = np.arange(len(cells))[::-1]
    return states.reshape(grid.rows, grid.columns)


class Windows:
    """Copies what a screen shows of one world, and what it will show when it follows the agent.

    A view that follows has the agent somewhere in it, so that all it may show lies less than its own size
    away from the agent in either direction. The cost depends on the size of the views only, not on that of
    the world.
    """

    def __init__(self, world: World) -> None:
        self._space = world.space
        self._cells: IntArray | None = None
        if isinstance(world.drawing, Grid):
            self._cells = first_state_of_cells(world.drawing)
            self._cell_of_state = world.drawing.cell_of_state

    def copy(
        self, sight: Sight, state: int, last: LastStep | None, q: FloatArray, visits: IntArray
    ) -> Window:
        """Return what ``sight`` shows of ``q`` and ``visits``, [P] each, with the agent in ``state``."""
        pairs = self._pairs_in(sight, state, last)
        window = Window(_blank(len(q), np.float64), _blank(len(q), np.int64), pairs, _blank(len(q), np.bool_))
        window.q[pairs] = q[pairs]
        window.visits[pairs] = visits[pairs]
        window.held[pairs] = True
        for array in (window.q, window.visits, window.held):
            array.flags.writeable = False
        return window

    def _pairs_in(self, sight: Sight, state: int, last: LastStep | None) -> IntArray:
        states = [np.array(self._met(sight, state, last), dtype=np.int64)]
        if sight.cells is not None and self._cells is not None:
            states += self._states_in(sight.cells, state)
        parts = [pairs_of_states(self._space, np.concatenate(states))]
        if sight.stretch is not None:
            length, first = sight.stretch
            here = int(self._space.first_pair[followed_state(self._space, state, last)])
            parts.append(self._run(here - length, here + length + len(self._space.action_names)))
            if first is not None:
                parts.append(self._run(first, first + length))
        return np.concatenate(parts)

    def _met(self, sight: Sight, state: int, last: LastStep | None) -> list[int]:
        """Return the states of which something is told outside of map and table."""
        states = [state]
        if last is not None:
            states += [each for each in (last.state, last.next_state) if each != NO_STATE]
            if last.learned:
                states.append(self._space.state_of(last.updated_pair))
        # what a screen last asked for may be of the world before this one
        if sight.pair is not None and sight.pair < self._space.pairs:
            states.append(self._space.state_of(sight.pair))
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

    def _run(self, first: int, last: int) -> IntArray:
        return np.arange(max(0, first), min(last, self._space.pairs), dtype=np.int64)


def followed_state(space: FiniteSpace, state: int, last: LastStep | None) -> int:
    """Return whose row a table follows: the agent's state, or the one it came from where that has no row."""
    return last.state if last is not None and not space.pairs_of(state) else state


def pairs_of_states(space: FiniteSpace, states: IntArray) -> IntArray:
    """Return the pairs that each of ``states`` owns, in one array."""
    first = space.first_pair[states]
    count = space.first_pair[states + 1] - first
    before = np.cumsum(count) - count
    return np.asarray(np.repeat(first - before, count) + np.arange(int(count.sum())))


def _blank(length: int, kind: type[np.generic]) -> npt.NDArray[Any]:
    """Return zeros that take memory and time only where something is written.

    numpy.zeros promises neither: what it gets from the heap it has to clear.
    """
    size = length * np.dtype(kind).itemsize
    private = getattr(mmap, "MAP_PRIVATE", None)
    if private is None:
        return np.frombuffer(mmap.mmap(-1, size), dtype=kind)
    return np.frombuffer(mmap.mmap(-1, size, flags=private | mmap.MAP_ANONYMOUS), dtype=kind)
