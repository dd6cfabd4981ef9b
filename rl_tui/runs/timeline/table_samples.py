"""Copies of the estimates at fixed steps, for the history of any cell."""

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
    """Q of one pair at N steps up to the current one."""

    pair: int
    """Number of the pair, 0 to P − 1."""
    step: IntArray
    """Steps, ascending from 0 to the current one, `[N]`."""
    value: FloatArray
    """Q of the pair at these steps, `[N]`."""


class TableSamples:
    """Copies of Q at multiples of a spacing, which doubles (dropping every other copy) once there are too
    many. Their positions depend only on the step number and table sizes, except on branches that were
    left. Tables too large for 16 copies have none.
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
        """Take the copy that is due of the estimates `q`, `[P]`."""
        self._tables.append(q.copy())
        if len(self._tables) == self._most or (len(self._tables) > 2 and self._nbytes > self._limits.samples):
            self._tables = self._tables[::2]
            self._spacing *= 2
        self.next_step = len(self._tables) * self._spacing

    def thin_out(self, branches: int) -> None:
        """Keep fewer copies: the branch is one of `branches` that are not current."""
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
        """Return the history of one estimate.

        Args:
            pair: Number of the pair.
            step: Current step.
            q: Current estimates, `[P]`.
            since: Step of the last edit of the world, whose earlier tables do not count, or None without
                an edit.
        """
        first = 0 if since is None else since // self._spacing + 1
        count = min(len(self._tables), -(-step // self._spacing))
        steps = [*(each * self._spacing for each in range(first, count)), step]
        values = [*(table[pair] for table in self._tables[first:count]), q[pair]]
        return CellHistory(pair, np.array(steps, dtype=np.int64), np.array(values, dtype=np.float64))
