"""The states of a map: its cells that are no walls, and what is known of each."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from rl_tui.worlds.drawing import CellKind, Grid
from rl_tui.worlds.grid.legend import LegendEntry
from rl_tui.worlds.grid.map import CellMap, with_border
from rl_tui.worlds.grid.moves import STEPS
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray

if TYPE_CHECKING:
    from rl_tui.worlds.grid.moves import CellArray


@dataclass(frozen=True, eq=False)
class GridStates:
    """S states in the order of their cells; every array is [S] unless it says otherwise."""

    map: CellMap

    @cached_property
    def numbers(self) -> IntArray:
        """The cell of each state, row · columns + column."""
        return np.flatnonzero(~self._is_wall.ravel())

    @cached_property
    def open_cells(self) -> BoolArray:
        """Where one can be, with a border around the map, [(rows + 2) · (columns + 2)]."""
        return with_border(~self._is_wall)

    @cached_property
    def places(self) -> CellArray:
        """The cell of each state in ``open_cells``."""
        return np.flatnonzero(self.open_cells).astype(np.int32)

    @cached_property
    def state_at(self) -> CellArray:
        """The state of each of ``open_cells``, anything where there is none."""
        states = np.zeros(len(self.open_cells), dtype=np.int32)
        states[self.places] = np.arange(len(self.places), dtype=np.int32)
        return states

    @cached_property
    def starts(self) -> IntArray:
        """The states to start in, [K]."""
        return np.flatnonzero(self._of(lambda entry: entry.kind is CellKind.START, np.bool_))

    @cached_property
    def ends(self) -> BoolArray:
        """Whether the episode ends on entering."""
        return self._of(lambda entry: entry.ends, np.bool_)

    @cached_property
    def exits(self) -> BoolArray:
        """Whether "exit" is the only action."""
        return self._of(lambda entry: entry.exit, np.bool_)

    @cached_property
    def rewards(self) -> FloatArray:
        """What each cell pays."""
        return self._of(lambda entry: entry.pays, np.float64)

    @cached_property
    def arrival(self) -> CellArray:
        """The state one is in after entering each: itself, or the start after falling off a cliff."""
        arrival = np.arange(len(self.numbers), dtype=np.int32)
        arrival[self._of(lambda entry: entry.back, np.bool_)] = self.starts[0]
        return arrival

    @cached_property
    def jump_to(self) -> CellArray:
        """The state that all actions lead to, −1 where they are moves."""
        code_of = {character: code for code, character in enumerate(self.map.characters)}
        target = np.full(len(self.map.entries), -1, dtype=np.int32)
        for code, entry in enumerate(self.map.entries):
            if entry.jump is not None:
                target[code] = np.flatnonzero(self._codes == code_of[entry.jump])[0]
        return target[self._codes]

    def allows(self, move: str) -> BoolArray | None:
        """Return where ``move`` is a move, None for everywhere."""
        if all(entry.only is None for entry in self.map.entries):
            return None
        return self._of(lambda entry: entry.only is None or move in entry.only, np.bool_)

    @cached_property
    def _is_wall(self) -> BoolArray:
        """Whether each cell of the map is a wall, [rows, columns]."""
        return self._lookup(lambda entry: entry.is_wall, np.bool_)[self.map.codes]

    @cached_property
    def _codes(self) -> npt.NDArray[np.uint8]:
        return self.map.codes.ravel()[self.numbers]

    def _lookup(self, quality: Callable[[LegendEntry], Any], kind: type[np.generic]) -> npt.NDArray[Any]:
        return np.array([quality(entry) for entry in self.map.entries], dtype=kind)

    def _of(self, quality: Callable[[LegendEntry], Any], kind: type[np.generic]) -> npt.NDArray[Any]:
        return self._lookup(quality, kind)[self._codes]


def grid_drawing(states: GridStates, actions: Sequence[str], wind: Sequence[int] = ()) -> Grid:
    """Return the drawing of a map; ``actions`` are the names of its actions, ``wind`` that of its columns."""
    rows, columns = states.map.codes.shape
    kinds = np.array([entry.kind for entry in states.map.entries], dtype=object)
    steps = [STEPS.get(name, (0, 0)) for name in actions]
    return Grid(
        rows=rows,
        columns=columns,
        kinds=tuple(kinds[states.map.codes.ravel()].tolist()),
        cell_of_state=tuple(states.numbers.tolist()),
        directions=tuple(step if any(step) else None for step in steps),
        wind=tuple(wind) if any(wind) else (),
        one_way=tuple(_one_way(states.map)),
    )


def _one_way(cells: CellMap) -> Iterator[tuple[int, tuple[int, int]]]:
    """Yield the cells, row by row, that are left in one direction only, each with its step."""
    ways = {
        code: STEPS[entry.only[0]]
        for code, entry in enumerate(cells.entries)
        if entry.only is not None and len(entry.only) == 1
    }
    codes = cells.codes.ravel()
    for cell in np.flatnonzero(np.isin(codes, list(ways))).tolist():
        yield cell, ways[int(codes[cell])]
