"""A table as rows in a list or a dict."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import compress
from operator import ne
from typing import Any

import numpy as np
from numpy import ndarray

from rl_tui.lab.programs.child.environments.numbering import Numbering
from rl_tui.lab.programs.child.tables.entries import (
    NAN,
    add_difference,
    number_of,
    plain_rows,
    raw_row,
    raw_rows,
    state_of,
)
from rl_tui.lab.programs.child.tables.held_table import Doubles, HeldTable


class RowTable(HeldTable):
    """A row for each state: a list of rows, an array of objects, or a dict of rows by observation.

    Rows are kept by their key: the observation in a dict, else their place.
    """

    def __init__(self, numbering: Numbering, name: str) -> None:
        super().__init__(numbering)
        self.name = name
        is_dict = name == "dict-of-arrays"
        self._length = dict.__len__ if is_dict else len  # not one of the user's
        self._are_keys_states = not is_dict or numbering.counts_from_0

    def take(self, table: Any) -> None:
        """Take the content of ``table`` for what was last seen."""
        self._numbers = [NAN] * self.cells
        self._kept: list[Any] = []
        self._place: dict[Any, int] = {}
        self.all_differences(table)

    def values(self) -> Doubles:
        """Return what was last seen, [S·A]."""
        return np.array(self._numbers, np.float64)

    def row(self, state: int) -> Sequence[float]:
        """Return what was last seen in a row, [A]."""
        return self._numbers[state * self.actions : (state + 1) * self.actions]

    def differences(self, table: Any, states: Iterable[int]) -> list[float]:
        """Return what differs now in the rows of ``states``, and what is new."""
        is_array = type(table) is ndarray
        if self.is_compared_whole or is_array or self._length(table) != len(self._kept):
            return self.all_differences(table)
        found: list[float] = []
        kept, find = self._kept, self._place.get
        is_dict, get = self.name == "dict-of-arrays", dict.get
        are_keys_states, key_of = self._are_keys_states, self.numbering.key
        for state in states:
            key = state if are_keys_states else key_of(state)
            place = find(key)
            if place is not None:
                row = get(table, key) if is_dict else table[place]
                if (row.tobytes() if type(row) is ndarray else row) != kept[place]:
                    self._note(state, place, row, found)
        return found

    def all_differences(self, table: Any) -> list[float]:
        """Return what differs now anywhere."""
        rows, kept = self._rows(table), self._kept
        now = raw_rows(rows)
        found: list[float] = []
        if len(rows) != len(kept):
            self._find_places(table, found)
            kept = self._kept
        if now != kept:
            keys = list(self._place)
            for place in list(compress(range(len(now)), map(ne, now, kept))):
                self._note(self._state(keys[place]), place, rows[place], found)
        return found

    def peek(self, table: Any, state: int) -> object:
        """Return the row of ``state`` as it is now, None where there is none."""
        if type(table) is ndarray:
            return table[self.numbering.place(state)].tolist()
        row = dict.get(table, self._key(state)) if issubclass(type(table), dict) else table[state]
        return list(row) if type(row) is list else raw_row(row)

    def rows_are_shared(self, table: Any) -> bool:
        """Return whether rows are one and the same object."""
        rows = list(map(id, self._rows(table)))
        return type(table) is not np.ndarray and len(set(rows)) < len(rows)

    def _rows(self, table: Any) -> list[Any]:
        if issubclass(type(table), dict):
            return list(dict.values(table))
        return plain_rows(table)

    def _key(self, state: int) -> Any:
        return state if self._are_keys_states else self.numbering.key(state)

    def _state(self, key: Any) -> int | None:
        return key if self.name != "dict-of-arrays" else state_of(self.numbering, key)

    def _find_places(self, table: Any, found: list[float]) -> None:
        """Find where in their order the rows stand, after some came or went."""
        keys = list(dict.keys(table)) if issubclass(type(table), dict) else range(len(table))
        if type(table) is ndarray:
            keys = range(self.numbering.states)
        before = dict(zip(self._place, self._kept, strict=True))
        self._place = {key: place for place, key in enumerate(keys)}
        self._kept = [before.pop(key, None) for key in keys]
        for key in before:
            state = self._state(key)
            if state is not None:
                self._set_row(state, [NAN] * self.actions, found)

    def _note(self, state: int | None, place: int, row: Any, found: list[float]) -> None:
        self._kept[place] = list(row) if type(row) is list else raw_row(row)
        if state is not None and len(row) == self.actions:
            self._set_row(state, row.tolist() if type(row) is ndarray else row, found)

    def _set_row(self, state: int, now: Iterable[Any], found: list[float]) -> None:
        numbers = self._numbers
        for cell, each in enumerate(now, state * self.actions):
            before, after = numbers[cell], each if type(each) is float else number_of(each)
            if before != after:
                add_difference(cell, before, after, found)
                numbers[cell] = after
