"""Recognising, reading and comparing the forms of a table.

Reading calls nothing of the user's: no property, no method of a user's class, no `__getitem__` that would add
an entry. `isinstance` may ask an object for its `__class__`, so types are compared instead.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import chain, compress, repeat
from operator import is_not, ne
from struct import Struct
from typing import Any, Final

import numpy as np
from numpy import ndarray

from rl_tui.programs.watched.child.environments.numbering import Numbering
from rl_tui.programs.watched.child.tables.held_table import Doubles, HeldTable

# Rows, keys and numbers


NAN: Final = float("nan")
MOST_CELLS: Final = 1_000_000


def number_of(value: object) -> float:
    """Return a table's entry, NaN if it is no number."""
    if type(value) is float:
        return value
    if type(value) is np.ndarray and value.size == 1 and value.dtype.kind in "fiu":
        return float(value.reshape(-1)[0])
    try:
        return float(value) if is_number(value) else NAN  # type: ignore[arg-type]
    except (OverflowError, TypeError):
        return NAN


def is_number(value: Any) -> bool:
    """Return True for a number, but not bool or complex."""
    return type(value) in (float, int) or (issubclass(type(value), np.number) and value.dtype.kind in "fiu")


def is_row(row: Any, actions: int) -> bool:
    """Return True for a row with a number for each action."""
    if type(row) is np.ndarray:
        return row.shape == (actions,) and row.dtype.kind in "fiu"
    return type(row) in (list, tuple) and len(row) == actions and all(map(_is_entry, row))


def _is_entry(value: object) -> bool:
    return type(value) is float or is_number(value) or (type(value) is np.ndarray and value.size == 1)


def raw_rows(rows: list[Any]) -> list[Any]:
    """Make `rows` quick to compare."""
    if rows and type(rows[0]) is np.ndarray:
        return list(map(np.ndarray.tobytes, rows))
    return rows


def raw_row(row: Any) -> object:
    """Make a row quick to compare."""
    return row.tobytes() if type(row) is np.ndarray else row


def plain_rows(table: Any) -> list[Any]:
    """Return the rows of lists or arrays of objects."""
    if type(table) is np.ndarray:
        rows: list[Any] = table.reshape(-1, table.shape[-1]).tolist()
        return rows
    return table  # type: ignore[no-any-return]


def _is_plain(key: object) -> bool:
    return type(key) is int or issubclass(type(key), (bool, np.integer, np.bool_))


def state_of(numbering: Numbering, key: Any) -> int | None:
    """Return the state of a dict's key, if any."""
    is_fit = (type(key) is tuple and all(map(_is_plain, key))) if numbering.is_tuple else _is_plain(key)
    try:
        return numbering.state(tuple(map(int, key)) if numbering.is_tuple else int(key)) if is_fit else None
    except ValueError:
        return None


def cell_of(numbering: Numbering, key: Any) -> int:
    """Return the cell of (observation, action), or −1."""
    if type(key) is tuple and len(key) == 2 and _is_plain(key[1]):
        state, action = state_of(numbering, key[0]), int(key[1]) - numbering.first_action
        if state is not None and 0 <= action < numbering.actions:
            return state * numbering.actions + action
    return -1


def add_difference(cell: int, before: float, after: float, found: list[float]) -> None:
    """Append a difference of one cell to `found`."""
    if before != after and (before == before or after == after):  # two NaN count as equal
        found += (cell, before, after)


def add_differences(first_cell: int, pairs: Iterable[tuple[float, float]], found: list[float]) -> None:
    """Append the differences in (before, after) `pairs` of neighbouring cells."""
    for cell, (before, after) in enumerate(pairs, first_cell):
        if before != after and (before == before or after == after):  # two NaN count as equal
            found += (cell, before, after)


# Arrays


_SMALL: Final = 16_384  # bytes; a smaller array is compared as a whole at each step
_CODES: Final = {"<f8": "d", "<f4": "f", "<i8": "q", "<i4": "i"}
"""Codes to unpack numbers of an array."""


class ArrayTable(HeldTable):
    """An array S×A, or with a dimension for each part of an observation."""

    name = "array"

    def take(self, table: Any) -> None:
        """Store the table."""
        self._dtype = table.dtype
        self._kept = bytearray(table.tobytes())
        self._width = self.actions * table.dtype.itemsize
        code = _CODES.get(table.dtype.str)
        self._numbers = self._decoded if code is None else Struct(f"={self.actions}{code}").unpack
        self.is_compared_whole = len(self._kept) <= _SMALL

    def values(self) -> Doubles:
        """Return the stored table."""
        return np.frombuffer(self._kept, self._dtype).astype(np.float64)

    def row(self, state: int) -> Sequence[float]:
        """Return a stored row."""
        begin = state * self._width
        return list(self._numbers(self._kept[begin : begin + self._width]))

    def differences(self, table: Any, states: Iterable[int]) -> list[float]:
        """Compare these rows, or all of a small table."""
        found: list[float] = []
        kept, width = self._kept, self._width
        if self.is_compared_whole:
            now = table.tobytes()
            if now == kept:
                return found
            for state in states:  # usually these are all changes
                begin = state * width
                before, row = kept[begin : begin + width], now[begin : begin + width]
                if row != before:
                    self._take_row(state, before, row, found)
            return found if now == kept else found + self._compare_all(now)
        is_tuple, place = self.numbering.is_tuple, self.numbering.place
        for state in states:
            begin = state * width
            before, row = kept[begin : begin + width], table[place(state) if is_tuple else state].tobytes()
            if row != before:
                self._take_row(state, before, row, found)
        return found

    def all_differences(self, table: Any) -> list[float]:
        """Compare everything."""
        now = table.tobytes()
        return [] if now == self._kept else self._compare_all(now)

    def peek(self, table: Any, state: int) -> object:
        """Return the current row."""
        return table[self.numbering.place(state)].tobytes()

    def _take_row(self, state: int, before: bytearray, now: bytes, found: list[float]) -> None:
        begin = state * self._width
        self._kept[begin : begin + self._width] = now
        add_differences(
            state * self.actions, zip(self._numbers(before), self._numbers(now), strict=True), found
        )

    def _compare_all(self, now: bytes) -> list[float]:
        before, after = self.values(), np.frombuffer(now, self._dtype).astype(np.float64)
        cells = np.flatnonzero((before != after) & ~(np.isnan(before) & np.isnan(after)))
        self._kept[:] = now
        found: list[float] = np.column_stack((cells, before[cells], after[cells])).ravel().tolist()
        return found

    def _decoded(self, row: bytes | bytearray) -> Sequence[float]:
        numbers: list[float] = np.frombuffer(row, self._dtype).tolist()
        return numbers


class ListedTable(HeldTable):
    """A table kept in one list."""

    _numbers: list[float]

    def values(self) -> Doubles:
        """Return the stored table."""
        return np.array(self._numbers, np.float64)

    def row(self, state: int) -> Sequence[float]:
        """Return a stored row."""
        return self._numbers[state * self.actions : (state + 1) * self.actions]


# Dicts by observation and action


class PairTable(ListedTable):
    """A dict of numbers by (observation, action)."""

    name = "dict-of-pairs"

    def take(self, table: Any) -> None:
        """Store the table."""
        self._numbers = [NAN] * self.cells
        self._known: dict[object, int] = {}
        self._row_keys: dict[int, list[object]] = {}
        self._read_keys(table)
        self._kept: list[object] = []
        self.all_differences(table)

    def differences(self, table: Any, states: Iterable[int]) -> list[float]:
        """Compare the rows of `states`."""
        if self.is_compared_whole or dict.__len__(table) != len(self._cells):
            return self.all_differences(table)
        found: list[float] = []
        numbers, actions = self._numbers, self.actions
        for state in states:
            begin, row = state * actions, self.peek(table, state)
            if row == numbers[begin : begin + actions]:  # fast if entries are the same objects
                continue
            for cell, each in enumerate(row, begin):
                if each is not None and each != numbers[cell]:
                    self._note(cell, each, found)
                    self._kept[self._place[cell]] = each
        return found

    def all_differences(self, table: Any) -> list[float]:
        """Compare everything."""
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
        """Return the current row, None for missing entries."""
        keys = self._row_keys.get(state) or self._keys_of_row(state)
        return list(map(dict.get, repeat(table), keys))

    def _read_keys(self, table: Any) -> None:
        self._cells = [self._cell(key) for key in dict.keys(table)]
        self._place = {cell: place for place, cell in enumerate(self._cells)}
        self._key_of = dict(zip(self._cells, dict.keys(table), strict=True))
        self._row_keys.clear()

    def _keys_of_row(self, state: int) -> list[object]:
        """Return the keys of a row, the dict's own objects for a fast lookup."""
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


# Lists and dicts of rows


class RowTable(ListedTable):
    """Rows by state: a list, an array of objects, or a dict by observation."""

    def __init__(self, numbering: Numbering, name: str) -> None:
        super().__init__(numbering)
        self.name = name
        is_dict = name == "dict-of-arrays"
        self._length = dict.__len__ if is_dict else len  # not a user's method
        self._are_keys_states = not is_dict or numbering.counts_from_0

    def take(self, table: Any) -> None:
        """Store the table."""
        self._numbers = [NAN] * self.cells
        self._kept: list[Any] = []
        self._place: dict[Any, int] = {}
        self.all_differences(table)

    def differences(self, table: Any, states: Iterable[int]) -> list[float]:
        """Compare the rows of `states`."""
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
        """Compare everything."""
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
        """Return the current row, or None."""
        if type(table) is ndarray:
            return table[self.numbering.place(state)].tolist()
        row = dict.get(table, self._key(state)) if issubclass(type(table), dict) else table[state]
        return list(row) if type(row) is list else raw_row(row)

    def rows_are_shared(self, table: Any) -> bool:
        """Return True if rows are the same object."""
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
