"""The table of estimates at moments fixed by step number, to tell how any cell went."""

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
    """How Q of one pair went up to the moment shown, at N steps."""

    pair: int
    """The pair, 0 to P − 1."""
    step: IntArray
    """[N], after how many steps, ascending from 0; the last is the moment shown."""
    value: FloatArray
    """[N], what Q of the pair was then."""


class TableSamples:
    """Copies of Q at multiples of a spacing that doubles, dropping every other copy, when there are many.

    Where they lie depends on the step number and the sizes of the tables alone, but for a branch that was
    left in between. Of a table of which there is no room for 16 copies there are none.
    """

    def __init__(self, pairs: int) -> None:
        self._limits = limits()
        room = self._limits.samples // (8 * pairs)
        self._most = min(MOST, room // 2 * 2) if room >= _LEAST else 0
        self._spacing = 1
        self._tables: list[FloatArray] = []
        self.next_step = 0 if self._most else None
        """The step after which the next copy is due; None where none are taken."""

    def add(self, q: FloatArray) -> None:
        """Take the copy that is due, of the estimates ``q``, [P]."""
        self._tables.append(q.copy())
        if len(self._tables) == self._most or (len(self._tables) > 2 and self._nbytes > self._limits.samples):
            self._tables = self._tables[::2]
            self._spacing *= 2
        self.next_step = len(self._tables) * self._spacing

    def thin_out(self, branches: int) -> None:
        """Keep fewer: their branch is one of ``branches`` that were left."""
        while len(self._tables) > _LEAST and self._nbytes > self._limits.samples_left // branches:
            self._tables = self._tables[::2]
            self._spacing *= 2
            self.next_step = len(self._tables) * self._spacing

    @property
    def _nbytes(self) -> int:
        return sum(table.nbytes for table in self._tables)

    def up_to(self, step: int) -> TableSamples:
        """Return those that were taken after at most ``step`` steps; the copies are shared."""
        shared = TableSamples(1)
        shared._most, shared._spacing = self._most, self._spacing
        shared._tables = self._tables[: step // self._spacing + 1]
        shared.next_step = len(shared._tables) * shared._spacing if shared._most else None
        return shared

    def history(self, pair: int, step: int, q: FloatArray, since: int | None = None) -> CellHistory:
        """Return how the estimate of ``pair`` went up to ``step``, after which the table is ``q``, [P].

        Tables up to the step ``since`` are those of another world; None: none is.
        """
        first = 0 if since is None else since // self._spacing + 1
        count = min(len(self._tables), -(-step // self._spacing))
        steps = [*(each * self._spacing for each in range(first, count)), step]
        values = [*(table[pair] for table in self._tables[first:count]), q[pair]]
        return CellHistory(pair, np.array(steps, dtype=np.int64), np.array(values, dtype=np.float64))
