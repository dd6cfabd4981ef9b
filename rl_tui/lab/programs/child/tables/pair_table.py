"""A table as numbers by observation and action."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import chain, compress, repeat
from operator import is_not
from typing import Any

import numpy as np

from rl_tui.lab.programs.child.tables.entries import (
    NAN,
    add_difference,
    cell_of,
    number_of,
)
from rl_tui.lab.programs.child.tables.held_table import Doubles, HeldTable


class PairTable(HeldTable):
    """A dict of numbers by (observation, action)."""

    name = "dict-of-pairs"

    def take(self, table: Any) -> None:
        """Take the content of ``table`` for what was last seen."""
        self._numbers = [NAN] * self.cells
        self._known: dict[object, int] = {}
        self._row_keys: dict[int, list[object]] = {}
        self._read_keys(table)
        self._kept: list[object] = []
        self.all_differences(table)

    def values(self) -> Doubles:
        """Return what was last seen, [S·A]."""
        return np.array(self._numbers, np.float64)

    def row(self, state: int) -> Sequence[float]:
        """Return what was last seen in a row, [A]."""
        return self._numbers[state * self.actions : (state + 1) * self.actions]

    def differences(self, table: Any, states: Iterable[int]) -> list[float]:
        """Return what differs now in the rows of ``states``, and what is new."""
        if self.is_compared_whole or dict.__len__(table) != len(self._cells):
            return self.all_differences(table)
        found: list[float] = []
        numbers, actions = self._numbers, self.actions
        for state in states:
            begin, row = state * actions, self.peek(table, state)
            if row == numbers[begin : begin + actions]:  # quick where entries are the same objects
                continue
            for cell, each in enumerate(row, begin):
                if each is not None and each != numbers[cell]:
                    self._note(cell, each, found)
                    self._kept[self._place[cell]] = each
        return found

    def all_differences(self, table: Any) -> list[float]:
        """Return what differs now anywhere."""
        if dict.__len__(table) != len(self._cells):
            self._read_keys(table)
            self._kept = []
        now = list(dict.values(table))
        found: list[float] = []
        if now == self._kept:
            return found
        if len(self._kept) == len(now):
            changed: Iterable[tuple[int, object]] = compress(
                zip(self._cells, now, strict=True), map(is_not, now, self._kept)
            )
        else:
            gone = {cell for cell, each in enumerate(self._numbers) if each == each} - set(self._cells)
            changed = chain(((cell, None) for cell in gone), zip(self._cells, now, strict=True))
        for cell, each in changed:
            if cell >= 0:
                self._note(cell, each, found)
        self._kept = now
        return found

    def peek(self, table: Any, state: int) -> list[Any]:
        """Return the row of ``state`` as it is now, None where it has no such entry."""
        keys = self._row_keys.get(state) or self._keys_of_row(state)
        return list(map(dict.get, repeat(table), keys))

    def _read_keys(self, table: Any) -> None:
        """Find the cell of each entry in their order, −1 for one that is none."""
        self._cells = [self._cell(key) for key in dict.keys(table)]
        self._place = {cell: place for place, cell in enumerate(self._cells)}
        self._key_of = dict(zip(self._cells, dict.keys(table), strict=True))
        self._row_keys.clear()

    def _keys_of_row(self, state: int) -> list[object]:
        """Return the keys of a row: the dict's own objects, by which an entry is found most quickly."""
        observation, first = self.numbering.key(state), self.numbering.first_action
        keys = [
            self._key_of.get(state * self.actions + action, (observation, first + action))
            for action in range(self.actions)
        ]
        self._row_keys[state] = keys
        return keys

    def _cell(self, key: Any) -> int:
        if key not in self._known:
            self._known[key] = cell_of(self.numbering, key)
        return self._known[key]

    def _note(self, cell: int, now: object, found: list[float]) -> None:
        before, after = self._numbers[cell], number_of(now)
        add_difference(cell, before, after, found)
        self._numbers[cell] = after
