"""The interface of a table's forms, its numbers, and arrays.

Reading calls nothing of the user's: no property, no method of a user's class, no `__getitem__` that would add
an entry. `isinstance` may ask an object for its `__class__`, so types are compared instead.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Sequence
from struct import Struct
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from rl_tui.programs.watched.child.environments.numbering import Numbering

# Rows and numbers


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


def is_entry(value: object) -> bool:
    """Return True for a number, or an array with one."""
    return type(value) is float or is_number(value) or (type(value) is np.ndarray and value.size == 1)


def add_differences(first_cell: int, pairs: Iterable[tuple[float, float]], found: list[float]) -> None:
    """Append the differences in (before, after) `pairs` of neighbouring cells."""
    for cell, (before, after) in enumerate(pairs, first_cell):
        if before != after and (before == before or after == after):  # two NaN count as equal
            found += (cell, before, after)


def differences_of(before: Doubles, after: Doubles) -> list[float]:
    """Return the differences of two tables, `[S·A]`."""
    cells = np.flatnonzero((before != after) & ~(np.isnan(before) & np.isnan(after)))
    found: list[float] = np.column_stack((cells, before[cells], after[cells])).ravel().tolist()
    return found


# A form


Doubles = npt.NDArray[np.float64]
_FEW: Final = 64  # cells of a small table


class HeldTable(ABC):
    """A table as last seen: `[S·A]` numbers, NaN for missing entries.

    Differences are flat lists of cell, old value and new value.
    """

    name: str

    def __init__(self, numbering: Numbering) -> None:
        self.numbering = numbering
        self.actions = numbering.actions
        self.cells = numbering.states * numbering.actions
        self.is_compared_whole = self.cells <= _FEW
        """True if `differences` compares the whole table each time."""

    @abstractmethod
    def take(self, table: Any) -> None:
        """Store the content of `table`."""

    @abstractmethod
    def values(self) -> Doubles:
        """Return the stored content."""

    @abstractmethod
    def row(self, state: int) -> Sequence[float]:
        """Return the stored row of `state`, `[A]`."""

    @abstractmethod
    def differences(self, table: Any, states: Iterable[int]) -> list[float]:
        """Return and store the changes in the rows of `states`."""

    @abstractmethod
    def all_differences(self, table: Any) -> list[float]:
        """Return and store all changes."""

    @abstractmethod
    def peek(self, table: Any, state: int) -> object:
        """Return the current row in a comparable form, or None."""

    def rows_are_shared(self, table: Any) -> bool:
        """Return True if rows are the same object."""
        return False


# Arrays


_SMALL: Final = 16_384  # bytes; a smaller array is compared as a whole at each step
_CODES: Final = {"<f8": "d", "<f4": "f", "<i8": "q", "<i4": "i"}


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
        before = self.values()
        self._kept[:] = now
        return differences_of(before, self.values())

    def _decoded(self, row: bytes | bytearray) -> Sequence[float]:
        numbers: list[float] = np.frombuffer(row, self._dtype).tolist()
        return numbers
