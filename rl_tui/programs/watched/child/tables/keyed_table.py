"""A table with rows by the states of a program's own world."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from enum import StrEnum
from itertools import islice
from typing import Any, Final, NamedTuple

import numpy as np

from rl_tui.programs.watched.child.environments.numbering import Numbering
from rl_tui.programs.watched.child.tables.forms import (
    MOST_CELLS,
    NAN,
    add_difference,
    is_number,
    number_of,
    state_of,
)
from rl_tui.programs.watched.child.tables.held_table import Doubles, HeldTable
from rl_tui.programs.watched.child.worlds.met import (
    MOST_ACTIONS,
    FixedStates,
    MetNumbering,
    UnfitError,
    key_of,
)

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


class KnownShape(NamedTuple):
    """A table's shape, whether keys are texts, and the number of actions."""

    shape: KeyShape
    has_texts: bool
    actions: int


_BY_PLACE: Final = (KeyShape.ARRAY, KeyShape.LISTS, KeyShape.ROWS)
"""Shapes in which an action is a place of a row."""


def shape_of(value: Any, examples: Sequence[Any]) -> KnownShape | None:
    """Return the shape of a table with a row for some states `examples`."""
    plain = [key_of(each) for each in examples]
    if type(value) is np.ndarray and value.dtype != object:
        return _shape_of_array(value, plain)
    if type(value) in (list, np.ndarray):
        return _shape_of_lists(value, plain)
    if _is_frame(value):
        return _shape_of_frame(value, examples, plain)
    return _shape_of_dict(value, examples, plain) if issubclass(type(value), dict) else None


def keyed_form(value: Any, numbering: Numbering) -> HeldTable | None:
    """Return `value` as a table for `numbering`, or None."""
    is_met = isinstance(numbering, MetNumbering)
    states = numbering if isinstance(numbering, MetNumbering) else FixedStates(numbering)
    try:
        examples = [states.key(each) for each in states.met[-_MOST_EXAMPLES:]]
        if not is_met and issubclass(type(value), dict):
            examples = list(_states_in(value, numbering))
        found = shape_of(value, examples)
    except (LookupError, TypeError, ValueError, AttributeError):
        return None
    if found is None or found.actions > numbering.actions:
        return None
    if found.shape in _BY_PLACE and not (states.are_actions_places and found.actions == numbering.actions):
        return None
    if not is_met and found.shape in (
        KeyShape.ARRAY,
        KeyShape.PLACED_DICTS,
    ):  # a larger array may be anything
        return None
    if not is_met and found.shape is KeyShape.LISTS and sizes_of(value)[:-1] != numbering.parts:
        return None
    return KeyedTable(numbering, states, found.shape, found.has_texts)


def _states_in(table: dict[Any, Any], numbering: Numbering) -> Iterator[Any]:
    for key in islice(dict.keys(table), _MOST_EXAMPLES):
        inner = (key[0], key[:-1]) if type(key) is tuple and key else ()
        for each in (key, *inner):
            if state_of(numbering, each) is not None:
                yield each


def sizes_of(lists: Any) -> tuple[int, ...]:
    """Return the lengths of nested lists, by depth."""
    return (len(lists), *sizes_of(lists[0])) if type(lists) is list and lists else ()


def _parts(key: Any) -> tuple[Any, ...]:
    return key if type(key) is tuple else (key,)


def _is_width(number: int) -> bool:
    return 2 <= number <= MOST_ACTIONS


def _shape_of_array(value: Any, plain: Sequence[Any]) -> KnownShape | None:
    if value.dtype.kind not in "fiu" or value.ndim < 2 or not _is_width(value.shape[-1]):
        return None
    for parts in map(_parts, plain):
        is_index = len(parts) == value.ndim - 1 and all(type(each) is int for each in parts)
        if not (is_index and all(0 <= each < size for each, size in zip(parts, value.shape, strict=False))):
            return None
    return KnownShape(KeyShape.ARRAY, False, value.shape[-1])


def _shape_of_lists(value: Any, plain: Sequence[Any]) -> KnownShape | None:
    shapes = set()
    for key in plain:
        row = value
        for part in _parts(key):
            if type(row) not in (list, np.ndarray) or type(part) is not int or not 0 <= part < len(row):
                return None
            row = row[part]
        if _is_dict_row(row):
            shapes.add((KeyShape.PLACED_DICTS, dict.__len__(row)))
        elif _is_row(row) and type(value) is list:
            shapes.add((KeyShape.LISTS, len(row)))
        else:
            return None
    if len(shapes) != 1:
        return None
    ((shape, width),) = shapes
    return KnownShape(shape, False, width)


def _is_row(row: Any) -> bool:
    return type(row) in (list, np.ndarray) and _is_width(len(row)) and all(map(is_number, row))


def _is_dict_row(row: Any) -> bool:
    is_dict = issubclass(type(row), dict) and _is_width(dict.__len__(row))
    return is_dict and all(map(is_number, dict.values(row)))


def _is_frame(value: Any) -> bool:
    kind = type(value)
    return kind.__name__ == "DataFrame" and kind.__module__.startswith("pandas")


def _shape_of_frame(value: Any, examples: Sequence[Any], plain: Sequence[Any]) -> KnownShape | None:
    if not _is_width(value.shape[1]) or value.shape[0] * value.shape[1] > MOST_CELLS:
        return None
    index = set(value.index.tolist())
    if any(str(each) in index for each in examples):
        return KnownShape(KeyShape.FRAME, True, value.shape[1])
    is_there = any(each in index for each in plain)
    return KnownShape(KeyShape.FRAME, False, value.shape[1]) if is_there else None


def _shape_of_dict(value: Any, examples: Sequence[Any], plain: Sequence[Any]) -> KnownShape | None:
    if not 0 < dict.__len__(value) <= MOST_CELLS:
        return None
    for original, key in zip(examples, plain, strict=True):
        for has_texts, each in ((False, key), (True, str(original))):
            row: Any = dict.get(value, each)
            if _is_dict_row(row):
                return KnownShape(KeyShape.DICTS, has_texts, dict.__len__(row))
            if row is not None and _is_row(row):
                return KnownShape(KeyShape.ROWS, has_texts, len(row))
    return _shape_of_pairs(value, examples, plain)


def _shape_of_pairs(value: Any, examples: Sequence[Any], plain: Sequence[Any]) -> KnownShape | None:
    first, number = next(iter(dict.items(value)))
    if type(first) is not tuple or not first or not is_number(number):
        return None
    actions = {key[-1] for key in dict.keys(value) if type(key) is tuple and key}
    if not _is_width(len(actions)):
        return None
    for original, key in zip(examples, plain, strict=True):
        for shape, has_texts, start in (
            (KeyShape.PAIRS, False, (key,)),
            (KeyShape.PAIRS, True, (str(original),)),
            (KeyShape.FLAT, False, _parts(key)),
        ):
            if any(dict.__contains__(value, (*start, action)) for action in actions):
                return KnownShape(shape, has_texts, len(actions))
    return None


class KeyedTable(HeldTable):
    """A table of `shape`, read by its states, or by their texts. Reading adds nothing to it."""

    def __init__(
        self, numbering: Numbering, states: MetNumbering | FixedStates, shape: KeyShape, has_texts: bool
    ) -> None:
        super().__init__(numbering)
        self.name, self._states = shape.value, states
        self._shape, self._has_texts = shape, has_texts
        self.is_compared_whole = False

    def take(self, table: Any) -> None:
        """Store the table."""
        self._kept: dict[int, tuple[float, ...]] = {}
        self._length = -1
        self.all_differences(table)

    def values(self) -> Doubles:
        """Return the stored table."""
        found = np.full(self.cells, NAN)
        for state, row in self._kept.items():
            found[state * self.actions : (state + 1) * self.actions] = row
        return found

    def row(self, state: int) -> Sequence[float]:
        """Return a stored row."""
        return self._kept.get(state, (NAN,) * self.actions)

    def differences(self, table: Any, states: Iterable[int]) -> list[float]:
        """Compare these rows. Raises ValueError if an action is a name, but rows have places."""
        if self._shape in _BY_PLACE and not self._states.are_actions_places:
            raise ValueError("the actions are not numbered from 0")
        if self._count(table) != self._length:
            return self.all_differences(table)
        found: list[float] = []
        for state in set(states):
            self._compare(state, self._row(table, state), found)
        return found

    def all_differences(self, table: Any) -> list[float]:
        """Compare everything."""
        self._length = self._count(table)
        if self._shape is KeyShape.FRAME:
            self._read_frame(table)
        found: list[float] = []
        for state in self._states.met:
            self._compare(state, self._row(table, state), found)
        return found

    def peek(self, table: Any, state: int) -> object:
        """Return the current row, or None."""
        return self._row(table, state)

    def _count(self, table: Any) -> int:
        if self._shape in (KeyShape.ARRAY, KeyShape.LISTS, KeyShape.PLACED_DICTS):
            return len(self._states.met)
        return len(table.index) if self._shape is KeyShape.FRAME else dict.__len__(table)

    def _compare(self, state: int, row: tuple[float, ...] | None, found: list[float]) -> None:
        before = self._kept.get(state)
        if row is None or row == before or len(row) != self.actions:
            return
        self._kept[state] = row
        for action, after in enumerate(row):
            add_difference(state * self.actions + action, before[action] if before else NAN, after, found)

    def _read_frame(self, table: Any) -> None:
        self._places = {key: place for place, key in enumerate(table.index.tolist())}
        self._columns = [self._states.action_of_key(each) for each in table.columns.tolist()]

    def _row(self, table: Any, state: int) -> tuple[float, ...] | None:
        original = self._states.key(state)
        try:
            key = str(original) if self._has_texts else key_of(original)
            return self._row_of(table, key)
        except (LookupError, TypeError, ValueError, UnfitError):
            return None

    def _row_of(self, table: Any, key: Any) -> tuple[float, ...] | None:
        match self._shape:
            case KeyShape.ARRAY | KeyShape.LISTS | KeyShape.PLACED_DICTS:
                row = table
                for part in _parts(key):
                    row = row[part]
                is_dict = self._shape is KeyShape.PLACED_DICTS
                return self._by_action(row, ()) if is_dict else _numbers(row)
            case KeyShape.FRAME:
                found = [NAN] * self.actions
                numbers = table.to_numpy()[self._places[key]]
                for action, value in zip(self._columns, numbers, strict=True):
                    if action is not None:
                        found[action] = float(value)
                return tuple(found)
            case KeyShape.ROWS:
                return _numbers(dict.__getitem__(table, key))
            case KeyShape.DICTS:
                return self._by_action(dict.__getitem__(table, key), ())
        return self._by_action(table, (key,) if self._shape is KeyShape.PAIRS else _parts(key))

    def _by_action(self, table: Any, start: tuple[Any, ...]) -> tuple[float, ...] | None:
        keys = [self._states.action_key(each) for each in range(self.actions)]
        found = [dict.get(table, (*start, key) if start else key) for key in keys]
        return None if all(each is None for each in found) else tuple(map(number_of, found))


def _numbers(row: Any) -> tuple[float, ...]:
    return tuple(map(number_of, row.tolist() if type(row) is np.ndarray else row))
