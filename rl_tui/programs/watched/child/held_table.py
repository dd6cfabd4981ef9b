"""What each form of a table can do."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Sequence
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from rl_tui.programs.watched.child.numbering import Numbering

Doubles = npt.NDArray[np.float64]
_FEW: Final = 64  # cells of a table that is so


class HeldTable(ABC):
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
