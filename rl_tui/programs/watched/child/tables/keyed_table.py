"""A table with rows by the states of a program's own world."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from enum import StrEnum
from functools import cache
from itertools import chain, compress, islice, repeat
from operator import ne
from typing import Any, Final, NamedTuple

import numpy as np

from rl_tui.programs.watched.child.environments.numbering import Numbering
from rl_tui.programs.watched.child.tables.forms import (
    MOST_CELLS,
    NAN,
    ArrayTable,
    Doubles,
    HeldTable,
    add_differences,
    is_entry,
    is_number,
    number_of,
)
from rl_tui.programs.watched.child.worlds.met import MOST_ACTIONS, MetNumbering, key_of, parts_of

_MOST_EXAMPLES: Final = 8


class KeyShape(StrEnum):
    """The place of the rows in a table."""

    ARRAY = "array"
    """An array, indexed by the parts of the state and the action."""
    LISTS = "lists"
    """Lists of lists, indexed in the same way."""
    PLACED_DICTS = "array-of-dicts"
    """An array or lists of dicts by action, indexed by the parts of the state."""
    ROWS = "dict-of-arrays"
    """A dict of rows, which are lists or arrays."""
    DICTS = "dict-of-dicts"
    """A dict of dicts by action."""
    PAIRS = "dict-of-pairs"
    """A dict by (state, action)."""
    FLAT = "dict-of-parts"
    """A dict by (part of the state, ..., action)."""
    FRAME = "data-frame"
    """A DataFrame of pandas with a row for each state and a column for each action."""


class _KnownShape(NamedTuple):
    """A table's shape, whether keys are texts, and the number of actions."""

    shape: KeyShape
    has_texts: bool
    actions: int


_BY_PLACE: Final = (KeyShape.ARRAY, KeyShape.LISTS, KeyShape.PLACED_DICTS)
"""Shapes in which the parts of a state are places."""
_ROWS: Final = (KeyShape.ARRAY, KeyShape.LISTS, KeyShape.ROWS)
"""Shapes in which an action is a place of a row."""


def shape_of(value: Any, examples: Sequence[Any], fixed: Numbering | None = None) -> _KnownShape | None:
    """Return the shape of a table with a row for some states `examples`. Its actions may be `fixed`."""
    plain = [key_of(each) for each in examples]
    if type(value) is np.ndarray and value.dtype != object:
        found = _shape_of_array(value, plain)
    elif type(value) in (list, np.ndarray):
        found = _shape_of_lists(value, plain)
    elif _is_frame(value):
        found = _shape_of_frame(value, examples, plain)
    else:
        found = _shape_of_dict(value, examples, plain, fixed) if issubclass(type(value), dict) else None
    least, most = (2, MOST_ACTIONS) if fixed is None else (1, fixed.actions)
    return found if found is not None and least <= found.actions <= most else None


def form_of(value: Any, numbering: Numbering) -> HeldTable | None:
    """Return `value` as a table for `numbering`, or None."""
    is_met = isinstance(numbering, MetNumbering)
    if not (is_met or 0 < numbering.states * numbering.actions <= MOST_CELLS):
        return None
    if type(value) is np.ndarray and value.dtype != object and not is_met:
        is_fit = value.shape == (*numbering.parts, numbering.actions) and value.dtype.kind in "fiu"
        return ArrayTable(numbering) if is_fit else None
    try:
        is_flat = _is_flat(value, numbering)
        found = shape_of(value, _examples(value, numbering, is_flat), None if is_met else numbering)
    except (LookupError, TypeError, ValueError, AttributeError):
        return None
    if found is None or found.actions > numbering.actions:
        return None
    if found.shape in _ROWS and not (numbering.are_actions_places and found.actions == numbering.actions):
        return None
    needs_fit, parts = found.shape in _BY_PLACE and not (is_met or is_flat), numbering.parts
    if needs_fit and sizes_of(value)[: len(parts)] != parts:
        return None  # a larger one may be anything
    return KeyedTable(numbering, found.shape, found.has_texts, is_flat)


def _is_flat(value: Any, numbering: Numbering) -> bool:
    """Return True if observations have several parts, but rows are listed by the number of the state."""
    is_listed = numbering.is_tuple and type(value) in (list, np.ndarray)
    return is_listed and len(value) == numbering.states != numbering.parts[0]


def _examples(value: Any, numbering: Numbering, is_flat: bool) -> list[Any]:
    some = numbering.met[-_MOST_EXAMPLES:]
    if type(value) in (list, np.ndarray):
        return [each if is_flat else numbering.place(each) for each in some]
    if isinstance(numbering, MetNumbering) or not issubclass(type(value), dict):
        return [numbering.key(each) for each in some]
    keys = islice(dict.keys(value), _MOST_EXAMPLES)
    inner = ((key, *((key[0], key[:-1]) if type(key) is tuple and key else ())) for key in keys)
    return [each for some in inner for each in some if _state_of(numbering, each) is not None]


def _state_of(numbering: Numbering, key: Any) -> int | None:
    try:
        return numbering.state(key_of(key))
    except (TypeError, ValueError):
        return None


def sizes_of(table: Any) -> tuple[int, ...]:
    """Return the lengths of an array or of nested lists, by depth."""
    if type(table) is np.ndarray:
        return tuple(table.shape)
    return (len(table), *sizes_of(table[0])) if type(table) is list and table else ()


def _shape_of_array(value: Any, plain: Sequence[Any]) -> _KnownShape | None:
    if value.dtype.kind not in "fiu" or value.ndim < 2:
        return None
    for parts in map(parts_of, plain):
        is_index = len(parts) == value.ndim - 1 and all(type(each) is int for each in parts)
        if not (is_index and all(0 <= each < size for each, size in zip(parts, value.shape, strict=False))):
            return None
    return _KnownShape(KeyShape.ARRAY, False, value.shape[-1])


def _shape_of_lists(value: Any, plain: Sequence[Any]) -> _KnownShape | None:
    shapes = set()
    for key in plain:
        row = value
        for part in parts_of(key):
            if type(row) not in (list, np.ndarray) or type(part) is not int or not 0 <= part < len(row):
                return None
            row = row[part]
        if _is_dict_row(row):
            shapes.add((KeyShape.PLACED_DICTS, dict.__len__(row)))
        elif _is_row(row):
            shapes.add((KeyShape.LISTS if type(value) is list else KeyShape.ARRAY, len(row)))
        else:
            return None
    if len(shapes) != 1:
        return None
    ((shape, width),) = shapes
    return _KnownShape(shape, False, width)


def _is_row(row: Any) -> bool:
    return type(row) in (list, tuple, np.ndarray) and len(row) > 0 and all(map(is_entry, row))


def _is_dict_row(row: Any) -> bool:
    is_dict = issubclass(type(row), dict) and dict.__len__(row) > 1
    return is_dict and all(map(is_number, dict.values(row)))


def _is_frame(value: Any) -> bool:
    kind = type(value)
    return kind.__name__ == "DataFrame" and kind.__module__.startswith("pandas")


def _shape_of_frame(value: Any, examples: Sequence[Any], plain: Sequence[Any]) -> _KnownShape | None:
    if value.shape[0] * value.shape[1] > MOST_CELLS:
        return None
    index = set(value.index.tolist())
    if any(str(each) in index for each in examples):
        return _KnownShape(KeyShape.FRAME, True, value.shape[1])
    is_there = any(each in index for each in plain)
    return _KnownShape(KeyShape.FRAME, False, value.shape[1]) if is_there else None


def _shape_of_dict(
    value: Any, examples: Sequence[Any], plain: Sequence[Any], fixed: Numbering | None
) -> _KnownShape | None:
    if not 0 < dict.__len__(value) <= MOST_CELLS:
        return None
    for original, key in zip(examples, plain, strict=True):
        for has_texts, each in ((False, key), (True, str(original))):
            row: Any = dict.get(value, each)
            if _is_dict_row(row):
                return _KnownShape(KeyShape.DICTS, has_texts, dict.__len__(row))
            if _is_row(row):
                return _KnownShape(KeyShape.ROWS, has_texts, len(row))
    return _shape_of_pairs(value, examples, plain, fixed)


def _shape_of_pairs(
    value: Any, examples: Sequence[Any], plain: Sequence[Any], fixed: Numbering | None
) -> _KnownShape | None:
    first, number = next(iter(dict.items(value)))
    if type(first) is not tuple or not first or not is_number(number):
        return None
    actions = {key[-1] for key in dict.keys(value) if type(key) is tuple and key}
    if fixed is not None:
        actions = {each for each in actions if fixed.action_of_key(each) is not None}
    for original, key in zip(examples, plain, strict=True):
        for shape, has_texts, start in (
            (KeyShape.PAIRS, False, (key,)),
            (KeyShape.PAIRS, True, (str(original),)),
            (KeyShape.FLAT, False, parts_of(key)),
        ):
            if any(dict.__contains__(value, (*start, action)) for action in actions):
                return _KnownShape(shape, has_texts, len(actions))
    return None


class KeyedTable(HeldTable):
    """A table of `shape`, read by its states, or by their texts. Reading adds nothing to it."""

    def __init__(self, numbering: Numbering, shape: KeyShape, has_texts: bool, is_flat: bool = False) -> None:
        super().__init__(numbering)
        self.name, self._shape, self._has_texts = shape.value, shape, has_texts
        self._is_met = isinstance(numbering, MetNumbering)
        self._has_rows, self._is_by_place = shape in _ROWS, shape in _BY_PLACE
        self._has_parts = shape in (KeyShape.PAIRS, KeyShape.FLAT)
        self.is_compared_whole = self.is_compared_whole and not self._is_met
        self._is_by_number = is_flat or not numbering.is_tuple
        place = parts_of if is_flat else numbering.place
        key = place if self._is_by_place else self._key_of
        self._key = key if self._is_met and self._has_parts else cache(key)  # its actions become known later
        self._states_by_key: dict[Any, int | None] = {}

    def take(self, table: Any) -> None:
        """Store the table."""
        self._numbers: dict[int, list[float]] = {}
        self._length = -1
        self._read: Any = None  # its entries were compared last, which belong to states
        self._entries: list[object] = []
        self._states: Sequence[int | None] = ()
        self.all_differences(table)

    def values(self) -> Doubles:
        """Return the stored table."""
        found = np.full(self.cells, NAN)
        for state, row in self._numbers.items():
            found[state * self.actions : (state + 1) * self.actions] = row
        return found

    def row(self, state: int) -> Sequence[float]:
        """Return a stored row."""
        return self._numbers.get(state, (NAN,) * self.actions)

    def differences(self, table: Any, states: Iterable[int]) -> list[float]:
        """Compare these rows. Raises ValueError if an action is a name, but rows have places."""
        if self._is_met and self._has_rows and not self.numbering.are_actions_places:
            raise ValueError("the actions are not numbered from 0")
        if self.is_compared_whole or self._count(table) != self._length:
            return self.all_differences(table)
        found: list[float] = []
        for state in states:
            self._compare(table, state, found)
        return found

    def all_differences(self, table: Any) -> list[float]:
        """Compare everything."""
        self._length = self._count(table)
        if self._shape is KeyShape.FRAME:
            self._places = {key: place for place, key in enumerate(table.index.tolist())}
            self._columns = [self.numbering.action_of_key(each) for each in table.columns.tolist()]
        found: list[float] = []
        for state in self._changed_states(table):
            self._compare(table, state, found)
        return found

    def peek(self, table: Any, state: int) -> object:
        """Return the current row, or None."""
        try:
            return _copied(_comparable(self._row(table, state)))
        except (LookupError, TypeError, ValueError):
            return None

    def rows_are_shared(self, table: Any) -> bool:
        """Return True if rows are the same object."""
        if self._shape not in (KeyShape.LISTS, KeyShape.ROWS):
            return False
        rows = list(map(id, table if type(table) is list else dict.values(table)))
        return len(set(rows)) < len(rows)

    def _count(self, table: Any) -> int:
        if self._is_by_place:
            return len(self.numbering.met)
        return len(table.index) if self._shape is KeyShape.FRAME else dict.__len__(table)

    def _changed_states(self, table: Any) -> Iterable[int]:
        """Return the states whose rows may have changed, all if it is not known which entry is whose."""
        is_dict = issubclass(type(table), dict)
        is_known = is_dict or (type(table) is list and self._is_by_number)
        if self._is_met or self._has_texts or not is_known:
            return self.numbering.met
        entries = list(dict.values(table) if is_dict else table)
        kinds = set(map(type, entries))
        if np.ndarray in kinds:
            entries = list(map(np.ndarray.tobytes if len(kinds) == 1 else _comparable, entries))
        if self._read is table and entries == self._entries:
            return ()
        if self._read is table and len(entries) == len(self._entries):
            places = list(compress(range(len(entries)), map(ne, entries, self._entries)))
            for place in places:
                self._entries[place] = _copied(entries[place])
            changed: Iterable[int | None] = [self._states[place] for place in places]
        else:
            self._read, self._entries = table, list(map(_copied, entries))
            self._states = list(map(self._state_of, dict.keys(table))) if is_dict else self.numbering.met
            changed = chain(self._states, self._numbers)
        return [each for each in dict.fromkeys(changed) if each is not None]

    def _state_of(self, key: Any) -> int | None:
        known = self._states_by_key
        if key not in known:
            has_parts = self._has_parts and type(key) is tuple and len(key) > 0
            state = (key[0] if self._shape is KeyShape.PAIRS else key[:-1]) if has_parts else key
            known[key] = _state_of(self.numbering, state)
        return known[key]

    def _compare(self, table: Any, state: int, found: list[float]) -> None:
        before = self._numbers.get(state)
        try:
            row = self._row(table, state)
            numbers = _numbers(row) if row is not None else before and [NAN] * self.actions
        except (LookupError, TypeError, ValueError):
            return
        if numbers and numbers != before and len(numbers) == self.actions:
            add_differences(state * self.actions, zip(self.row(state), numbers, strict=True), found)
            self._numbers[state] = numbers

    def _row(self, table: Any, state: int) -> Any:
        key, row = self._key(state), table
        if self._has_parts:
            return _by_action(table, key)
        if self._is_by_place:
            for part in key:
                row = row[part]
        elif self._shape is KeyShape.FRAME:
            row = [NAN] * self.actions
            for action, value in zip(self._columns, table.to_numpy()[self._places[key]], strict=True):
                if action is not None:
                    row[action] = float(value)
        else:
            row = dict.get(table, key)
        if type(row) is np.ndarray:
            return row.tolist() if row.dtype == object else row
        return _by_action(row, self.numbering.action_keys) if issubclass(type(row), dict) else row

    def _key_of(self, state: int) -> Any:
        original = self.numbering.key(state)
        key = str(original) if self._has_texts else key_of(original)
        if not self._has_parts:
            return key
        start = (key,) if self._shape is KeyShape.PAIRS else parts_of(key)
        return [(*start, each) for each in self.numbering.action_keys]


def _by_action(row: Any, keys: Sequence[Any]) -> list[Any] | None:
    found = list(map(dict.get, repeat(row), keys))
    return None if all(each is None for each in found) else found


def _comparable(row: Any) -> object:
    return row.tobytes() if type(row) is np.ndarray else row


def _copied(row: object) -> object:
    if type(row) is list:
        return list(row)
    return dict(row) if issubclass(type(row), dict) else row  # type: ignore[call-overload]


def _numbers(row: Any) -> list[float]:
    numbers = row.tolist() if type(row) is np.ndarray else row
    return [each if type(each) is float else number_of(each) for each in numbers]
