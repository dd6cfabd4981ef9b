"""The interface of the forms of a table."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Sequence
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from rl_tui.programs.watched.child.environments.numbering import Numbering

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
        ...

    @abstractmethod
    def values(self) -> Doubles:
        """Return the stored content."""
        ...

    @abstractmethod
    def row(self, state: int) -> Sequence[float]:
        """Return the stored row of `state`, `[A]`."""
        ...

    @abstractmethod
    def differences(self, table: Any, states: Iterable[int]) -> list[float]:
        """Return and store the changes in the rows of `states`."""
        ...

    @abstractmethod
    def all_differences(self, table: Any) -> list[float]:
        """Return and store all changes."""
        ...

    @abstractmethod
    def peek(self, table: Any, state: int) -> object:
        """Return the current row in a comparable form, or None."""
        ...

    def rows_are_shared(self, table: Any) -> bool:
        """Return True if rows are the same object."""
        return False
