"""Columns that grow at their end, and whose older part can be forgotten."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

_FIRST_ROOM = 1024
_GROWTH = 8  # so that little is ever moved; room that is not written to takes no memory yet


class Columns:
    """Columns of the types ``dtypes``, [N] each. What :meth:`views` gives out never changes."""

    def __init__(self, dtypes: Sequence[npt.DTypeLike]) -> None:
        self._rooms = [np.empty(0, dtype) for dtype in dtypes]
        self._length = 0

    def __len__(self) -> int:
        return self._length

    def add(self, parts: Sequence[npt.NDArray[Any]]) -> None:
        """Add ``parts``, an array for each column, all of one length."""
        end = self._length + len(parts[0])
        if end > len(self._rooms[0]):
            room = max(_FIRST_ROOM, _GROWTH * end)
            self._rooms = [self._moved(each, room) for each in self._rooms]
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
        self._rooms = [column[first : self._length].copy() for column in self._rooms]
        self._length -= first

    def clear(self) -> None:
        """Forget all rows."""
        self.forget(self._length)

    def _moved(self, column: npt.NDArray[Any], room: int) -> npt.NDArray[Any]:
        moved = np.empty(room, column.dtype)
        moved[: self._length] = column[: self._length]
        return moved
