"""A table as an array."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from struct import Struct
from typing import Any, Final

import numpy as np

from rl_tui.lab.programs.child.tables.entries import (
    add_differences,
)
from rl_tui.lab.programs.child.tables.held_table import Doubles, HeldTable

_SMALL: Final = 16_384  # bytes of an array that is compared as a whole at each step
_CODES: Final = {"<f8": "d", "<f4": "f", "<i8": "q", "<i4": "i"}
"""How numbers of an array are written one by one."""


class ArrayTable(HeldTable):
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
        if self.is_compared_whole:
            now = table.tobytes()
            if now == kept:
                return found
            for state in states:  # mostly these are all that changed
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
        """Return what differs now anywhere."""
        now = table.tobytes()
        return [] if now == self._kept else self._compare_all(now)

    def peek(self, table: Any, state: int) -> object:
        """Return the row of ``state`` as it is now."""
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
