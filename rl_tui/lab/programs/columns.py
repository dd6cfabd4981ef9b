"""Columns that grow at their end, and whose older part can be forgotten."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt


class Columns:
    """Columns of the types ``dtypes``, [N] each. What :meth:`views` gives out never changes.

    Up to ``room`` rows nothing is ever moved; room that is not written to takes no memory yet.
    """

    def __init__(self, dtypes: Sequence[npt.DTypeLike], room: int = 0) -> None:
        self._rooms = [np.empty(room, dtype) for dtype in dtypes]
        self._length = 0

    def __len__(self) -> int:
        return self._length

    def add(self, parts: Sequence[npt.NDArray[Any]]) -> None:
        """Add ``parts``, an array for each column, all of one length."""
        end = self._length + len(parts[0])
        if end > len(self._rooms[0]):
            self._move(0, 2 * end)
        for column, part in zip(self._rooms, parts, strict=True):
            column[self._length : end] = part
        self._length = end

    def views(self) -> list[npt.NDArray[Any]]:
        """Return the columns so far."""
        return [column[: self._length] for column in self._rooms]

    def frozen(self) -> Columns:
        """Return them as they are now, which another thread may read."""
        frozen = Columns(())
        frozen._rooms, frozen._length = self.views(), self._length
        return frozen

    def forget(self, first: int) -> None:
        """Forget the ``first`` rows."""
        self._move(first, len(self._rooms[0]))

    def clear(self) -> None:
        """Forget all rows."""
        self.forget(self._length)

    def _move(self, first: int, room: int) -> None:
        """Go on in other memory, of ``room`` rows, with what stands from row ``first`` on."""
        kept = [column[first : self._length] for column in self._rooms]
        self._rooms = [np.empty(room, column.dtype) for column in kept]
        self._length -= first
        for column, part in zip(self._rooms, kept, strict=True):
            column[: self._length] = part
