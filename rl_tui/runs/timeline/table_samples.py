"""Copies of the estimates at fixed steps, for histories."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from rl_tui.runs.timeline.checkpoints import limits
from rl_tui.worlds.mdp.space import FloatArray, IntArray

MOST: Final = 256
_LEAST: Final = 16


@dataclass(frozen=True, slots=True, eq=False)
class CellHistory:
    """Q of one pair at N steps."""

    pair: int
    """Number of the pair, 0 to P − 1."""
    step: IntArray
    """Steps, ascending from 0 to the current one, `[N]`."""
    value: FloatArray
    """Q of the pair at these steps, `[N]`."""


@dataclass(frozen=True, slots=True, eq=False)
class ErrorHistory:
    """The error of all estimates at N steps."""

    step: IntArray
    """Steps, ascending to the current one, `[N]`."""
    error: FloatArray
    """Root of the mean squared error over all pairs, `[N]`."""


class TableSamples:
    """Copies of Q at multiples of a spacing, which doubles once there are too many.

    Positions depend only on step number and table sizes, except on old branches. Tables too large for 16
    copies have none.
    """

    def __init__(self, pairs: int) -> None:
        self._limits = limits()
        room = self._limits.samples // (8 * pairs)
        self._most = min(MOST, room // 2 * 2) if room >= _LEAST else 0
        self._spacing = 1
        self._tables: list[FloatArray] = []
        self.next_step = 0 if self._most else None
        """Step of the next copy, or None if no copies are taken."""

    def add(self, q: FloatArray) -> None:
        """Take the copy that is due of `q`, `[P]`."""
        self._tables.append(q.copy())
        if len(self._tables) == self._most or (len(self._tables) > 2 and self._nbytes > self._limits.samples):
            self._tables = self._tables[::2]
            self._spacing *= 2
        self.next_step = len(self._tables) * self._spacing

    def thin_out(self, branches: int) -> None:
        """Keep fewer copies of one of `branches` that are not current."""
        while len(self._tables) > _LEAST and self._nbytes > self._limits.samples_left // branches:
            self._tables = self._tables[::2]
            self._spacing *= 2
            self.next_step = len(self._tables) * self._spacing

    @property
    def _nbytes(self) -> int:
        return sum(table.nbytes for table in self._tables)

    def up_to(self, step: int) -> TableSamples:
        """Return the copies up to `step`, sharing memory."""
        shared = TableSamples(1)
        shared._most, shared._spacing = self._most, self._spacing
        shared._tables = self._tables[: step // self._spacing + 1]
        shared.next_step = len(shared._tables) * shared._spacing if shared._most else None
        return shared

    def history(self, pair: int, step: int, q: FloatArray, since: int | None = None) -> CellHistory:
        """Return the history of one estimate, ending with `q`, `[P]`, at `step`.

        Tables before `since`, the step of the last edit, do not count.
        """
        steps, tables = self._since(since, step, q)
        return CellHistory(pair, steps, np.array([table[pair] for table in tables], dtype=np.float64))

    def errors(self, exact: FloatArray, step: int, q: FloatArray, since: int | None = None) -> ErrorHistory:
        """Return the history of the distance from `exact`, `[P]`, likewise."""
        steps, tables = self._since(since, step, q)
        return ErrorHistory(steps, np.sqrt(np.mean((np.array(tables) - exact) ** 2, axis=1)))

    def _since(self, since: int | None, step: int, q: FloatArray) -> tuple[IntArray, list[FloatArray]]:
        first = 0 if since is None else since // self._spacing + 1
        count = min(len(self._tables), -(-step // self._spacing))
        steps = [*(each * self._spacing for each in range(first, count)), step]
        return np.array(steps, dtype=np.int64), [*self._tables[first:count], q]
