"""The forms in which programs keep their table: how each is recognised, read, and compared with before.

Reading calls nothing of the user's: no property, no method of a class of theirs, no ``__getitem__`` that
would add an entry. (``isinstance`` may ask an object for its ``__class__``; so types are asked.)
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Sequence
from itertools import chain, compress
from operator import is_not
from struct import Struct
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from rl_tui.lab.programs.child.environments.numbering import Numbering

Doubles = npt.NDArray[np.float64]
MOST_CELLS: Final = 1_000_000
_SMALL: Final = 65_536  # bytes of an array that is compared as a whole at each step
_FEW: Final = 64  # cells of a table that is so
_CODES: Final = {"<f8": "d", "<f4": "f", "<i8": "q", "<i4": "i"}
"""How numbers of an array are written one by one."""
_NAN: Final = float("nan")


class StoredTable(ABC):
    """One table as it was last seen: [S·A] numbers, NaN where it has no such entry.

    Differences are lists of numbers, three for each cell: the cell, what stood there and what stands there.
    """

    name: str

    def __init__(self, numbering: Numbering) -> None:
        self.numbering = numbering
        self.actions = numbering.actions
        self.cells = numbering.states * numbering.actions
        self.is_compared_whole = self.cells <= _FEW
        """Whether :meth:`differences` compares the whole table each time."""

    @abstractmethod
    def take(self, table: Any) -> None:
        """Take the content of ``table`` for what was last seen."""

    @abstractmethod
    def values(self) -> Doubles:
        """Return what was last seen."""

    @abstractmethod
    def row(self, state: int) -> Sequence[float]:
        """Return what was last seen in the row of ``state``, [A]."""

    @abstractmethod
    def differences(self, table: Any, states: Iterable[int]) -> list[float]:
        """Return what differs now in the rows of ``states``, and what is new, and take it."""

    @abstractmethod
    def all_differences(self, table: Any) -> list[float]:
        """Return what differs now anywhere, and take it."""

    @abstractmethod
    def peek(self, table: Any, state: int) -> object:
        """Return the row of ``state`` as it is now, in a form of its own, None where there is none."""

    def rows_are_shared(self, table: Any) -> bool:
        """Return whether rows of the table are one and the same object."""
        return False


class ArrayTable(StoredTable):
    """An array S×A, of a tuple of observations with a dimension for each part."""

    name = "array"

    def take(self, table: Any) -> None:
        """Take the content of ``table`` for what was last seen."""
        self._dtype = table.dtype
        self._kept = bytearray(table.tobytes())
        self._width = self.actions * table.dtype.itemsize
        code = _CODES.get(table.dtype.str)
        self._numbers = self._decoded if code is None else Struct(f"={self.actions}{code}").unpack
        self.is_compared_whole = len(self._kept) <= _SMALL

    def values(self) -> Doubles:
        """Return what was last seen, [S·A]."""
        return np.frombuffer(self._kept, self._dtype).astype(np.float64)

    def row(self, state: int) -> Sequence[float]:
        """Return what was last seen in a row, [A]."""
        begin = state * self._width
        return list(self._numbers(self._kept[begin : begin + self._width]))

    def differences(self, table: Any, states: Iterable[int]) -> list[float]:
        """Return what differs now in the rows of ``states``, and what is new."""
        found: list[float] = []
        kept, width = self._kept, self._width
        if not self.is_compared_whole:
            for state in states:
                self._compare(state, table[self.numbering.place(state)].tobytes(), found)
            return found
        now = table.tobytes()
        if now == kept:
            return found
        for state in states:  # mostly the first of them is all that changed
            begin = state * width
            if now[begin : begin + width] != kept[begin : begin + width]:
                self._compare(state, now[begin : begin + width], found)
                if now == kept:
                    return found
        return found + self._compare_all(now)

    def all_differences(self, table: Any) -> list[float]:
        """Return what differs now anywhere."""
        now = table.tobytes()
        return [] if now == self._kept else self._compare_all(now)

    def peek(self, table: Any, state: int) -> object:
        """Return the row of ``state`` as it is now."""
        return table[self.numbering.place(state)].tobytes()

    def _compare(self, state: int, now: bytes, found: list[float]) -> None:
        begin = state * self._width
        before = self._kept[begin : begin + self._width]
        if now != before:
            self._kept[begin : begin + self._width] = now
            pairs = zip(self._numbers(before), self._numbers(now), strict=True)
            _add_differences(state * self.actions, pairs, found)

    def _compare_all(self, now: bytes) -> list[float]:
        before, after = self.values(), np.frombuffer(now, self._dtype).astype(np.float64)
        cells = np.flatnonzero((before != after) & ~(np.isnan(before) & np.isnan(after)))
        self._kept[:] = now
        found: list[float] = np.column_stack((cells, before[cells], after[cells])).ravel().tolist()
        return found

    def _decoded(self, row: bytes | bytearray) -> Sequence[float]:
        numbers: list[float] = np.frombuffer(row, self._dtype).tolist()
        return numbers


class RowTable(StoredTable):
    """A row for each state: a list of rows, an array of objects, or a dict of rows by observation.

    Rows are kept by their key: the observation in a dict, else their place.
    """

    def __init__(self, numbering: Numbering, name: str) -> None:
        super().__init__(numbering)
        self.name = name

    def take(self, table: Any) -> None:
        """Take the content of ``table`` for what was last seen."""
        self._numbers = [_NAN] * self.cells
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
        if type(table) is np.ndarray or len(table) != len(self._kept):
            return self.all_differences(table)
        found: list[float] = []
        for state in states:
            key = self._key(state)
            place = self._place.get(key)
            if place is not None:
                row = dict.get(table, key) if issubclass(type(table), dict) else table[place]
                if _raw(row) != self._kept[place]:
                    self._note(key, place, row, found)
        return found + self.all_differences(table) if self.is_compared_whole else found

    def all_differences(self, table: Any) -> list[float]:
        """Return what differs now anywhere."""
        rows, kept = self._rows(table), self._kept
        now = _raw_of_all(rows)
        found: list[float] = []
        if len(rows) != len(kept):
            self._find_places(table, found)
            kept = self._kept
        if now != kept:
            keys = list(self._place)
            changed = [place for place, (new, old) in enumerate(zip(now, kept, strict=True)) if new != old]
            for place in changed:
                self._note(keys[place], place, rows[place], found)
        return found

    def peek(self, table: Any, state: int) -> object:
        """Return the row of ``state`` as it is now, None where there is none."""
        if type(table) is np.ndarray:
            return table[self.numbering.place(state)].tolist()
        row = dict.get(table, self._key(state)) if issubclass(type(table), dict) else table[state]
        return list(row) if type(row) is list else _raw(row)

    def rows_are_shared(self, table: Any) -> bool:
        """Return whether rows are one and the same object."""
        rows = list(map(id, self._rows(table)))
        return type(table) is not np.ndarray and len(set(rows)) < len(rows)

    def _rows(self, table: Any) -> list[Any]:
        if issubclass(type(table), dict):
            return list(dict.values(table))
        return _plain_rows(table)

    def _key(self, state: int) -> Any:
        return self.numbering.key(state) if self.name == "dict-of-arrays" else state

    def _state(self, key: Any) -> int | None:
        return key if self.name != "dict-of-arrays" else _state(self.numbering, key)

    def _find_places(self, table: Any, found: list[float]) -> None:
        """Find where in their order the rows stand, after some came or went."""
        keys = list(dict.keys(table)) if issubclass(type(table), dict) else range(len(table))
        if type(table) is np.ndarray:
            keys = range(self.numbering.states)
        before = dict(zip(self._place, self._kept, strict=True))
        self._place = {key: place for place, key in enumerate(keys)}
        self._kept = [before.pop(key, None) for key in keys]
        for key in before:
            state = self._state(key)
            if state is not None:
                self._set_row(state, [_NAN] * self.actions, found)

    def _note(self, key: Any, place: int, row: Any, found: list[float]) -> None:
        self._kept[place] = list(row) if type(row) is list else _raw(row)
        state = self._state(key)
        if state is not None and len(row) == self.actions:
            entries = row.tolist() if type(row) is np.ndarray else row
            now = [each if type(each) is float else number_of(each) for each in entries]
            self._set_row(state, now, found)

    def _set_row(self, state: int, now: list[float], found: list[float]) -> None:
        begin = state * self.actions
        before = self._numbers[begin : begin + self.actions]
        _add_differences(begin, zip(before, now, strict=True), found)
        self._numbers[begin : begin + self.actions] = now


class PairTable(StoredTable):
    """A dict of numbers by (observation, action)."""

    name = "dict-of-pairs"

    def take(self, table: Any) -> None:
        """Take the content of ``table`` for what was last seen."""
        self._numbers = [_NAN] * self.cells
        self._known: dict[object, int] = {}
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
        if len(table) != len(self._cells):
            return self.all_differences(table)
        found: list[float] = []
        numbers, get, first = self._numbers, dict.get, self.numbering.first_action
        for state in states:
            key, begin = self.numbering.key(state), state * self.actions
            for action in range(self.actions):
                each = get(table, (key, first + action))
                if each is not None and each != numbers[begin + action]:
                    self._note(begin + action, each, found)
                    self._kept[self._place[begin + action]] = each
        return found + self.all_differences(table) if self.is_compared_whole else found

    def all_differences(self, table: Any) -> list[float]:
        """Return what differs now anywhere."""
        if len(table) != len(self._cells):
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

    def peek(self, table: Any, state: int) -> object:
        """Return the row of ``state`` as it is now."""
        key, first = self.numbering.key(state), self.numbering.first_action
        return [dict.get(table, (key, first + action)) for action in range(self.actions)]

    def _read_keys(self, table: Any) -> None:
        """Find the cell of each entry in their order, −1 for one that is none."""
        self._cells = [self._cell(key) for key in dict.keys(table)]
        self._place = {cell: place for place, cell in enumerate(self._cells)}

    def _cell(self, key: Any) -> int:
        if key not in self._known:
            self._known[key] = _cell(self.numbering, key)
        return self._known[key]

    def _note(self, cell: int, now: object, found: list[float]) -> None:
        before, after = self._numbers[cell], number_of(now)
        _add_differences(cell, ((before, after),), found)
        self._numbers[cell] = after


def form_of(value: object, numbering: Numbering) -> StoredTable | None:
    """Return the form of a table for the states and actions of ``numbering`` that ``value`` has, if any."""
    if not 0 < numbering.states * numbering.actions <= MOST_CELLS:
        return None
    if type(value) is np.ndarray:
        shapes = {(*numbering.parts, numbering.actions), (numbering.states, numbering.actions)}
        if value.shape not in shapes or value.dtype.kind not in "fiuO":
            return None
        if value.dtype.kind == "O":
            return RowTable(numbering, "array") if _is_row(_plain_rows(value)[0], numbering.actions) else None
        return ArrayTable(numbering) if value.shape == (*numbering.parts, numbering.actions) else None
    if issubclass(type(value), dict):
        return _form_of_dict(value, numbering)
    is_list = type(value) is list and len(value) == numbering.states
    if is_list and all(_is_row(row, numbering.actions) for row in value):  # type: ignore[attr-defined]
        return RowTable(numbering, "lists")
    return None


def _form_of_dict(value: dict[Any, Any], numbering: Numbering) -> StoredTable | None:
    key, entry = next(iter(dict.items(value)), (None, None))
    if _state(numbering, key) is not None and _is_row(entry, numbering.actions):
        return RowTable(numbering, "dict-of-arrays")
    is_pair = type(key) is tuple and _cell(numbering, key) >= 0
    return PairTable(numbering) if is_pair and _is_number(entry) else None


def number_of(value: object) -> float:
    """Return what stands in a table as a number, NaN where it is none."""
    if type(value) is float:
        return value
    if type(value) is np.ndarray and value.size == 1 and value.dtype.kind in "fiu":
        return float(value.reshape(-1)[0])
    try:
        return float(value) if _is_number(value) else _NAN  # type: ignore[arg-type]
    except (OverflowError, TypeError):
        return _NAN


def _is_number(value: object) -> bool:
    return type(value) in (float, int) or (issubclass(type(value), np.number) and value.dtype.kind in "fiu")


def _is_row(row: Any, actions: int) -> bool:
    if type(row) is np.ndarray:
        return row.shape == (actions,) and row.dtype.kind in "fiu"
    return type(row) in (list, tuple) and len(row) == actions and all(map(_is_entry, row))


def _is_entry(value: object) -> bool:
    return type(value) is float or _is_number(value) or (type(value) is np.ndarray and value.size == 1)


def _raw_of_all(rows: list[Any]) -> list[Any]:
    if rows and type(rows[0]) is np.ndarray:
        return list(map(np.ndarray.tobytes, rows))
    return rows


def _raw(row: Any) -> object:
    return row.tobytes() if type(row) is np.ndarray else row


def _plain_rows(table: Any) -> list[Any]:
    if type(table) is np.ndarray:
        rows: list[Any] = table.reshape(-1, table.shape[-1]).tolist()
        return rows
    return table  # type: ignore[no-any-return]


def _is_plain(key: object) -> bool:
    return type(key) is int or issubclass(type(key), (bool, np.integer, np.bool_))


def _state(numbering: Numbering, key: Any) -> int | None:
    """Return the state of a key of a dict, None where it is no observation."""
    is_fit = (type(key) is tuple and all(map(_is_plain, key))) if numbering.is_tuple else _is_plain(key)
    try:
        return numbering.state(tuple(map(int, key)) if numbering.is_tuple else int(key)) if is_fit else None
    except ValueError:
        return None


def _cell(numbering: Numbering, key: Any) -> int:
    """Return the cell of a key (observation, action), −1 where it is none."""
    if type(key) is tuple and len(key) == 2 and _is_plain(key[1]):
        state, action = _state(numbering, key[0]), int(key[1]) - numbering.first_action
        if state is not None and 0 <= action < numbering.actions:
            return state * numbering.actions + action
    return -1


def _add_differences(first_cell: int, pairs: Iterable[tuple[float, float]], found: list[float]) -> None:
    for cell, (before, after) in enumerate(pairs, first_cell):
        if before != after and (before == before or after == after):  # two NaN do not differ
            found += (cell, before, after)
