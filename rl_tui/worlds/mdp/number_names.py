"""States that are called by numbers, without a text kept for each."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import overload

import numpy as np

from rl_tui.worlds.mdp.space import IntArray


class NumberNames(Sequence[str]):
    """The names "3", "4", "7", … of rising ``numbers``, [n], each made when it is asked for.

    Raises ValueError where the numbers do not rise: no two states may be called alike.
    """

    __slots__ = ("numbers",)

    def __init__(self, numbers: IntArray) -> None:
        if not bool(np.all(np.diff(numbers) > 0)):
            raise ValueError("state_names: expected numbers that rise")
        self.numbers = numbers

    def __len__(self) -> int:
        return len(self.numbers)

    @overload
    def __getitem__(self, index: int) -> str: ...

    @overload
    def __getitem__(self, index: slice) -> NumberNames: ...

    def __getitem__(self, index: int | slice) -> str | NumberNames:
        if isinstance(index, slice):
            return NumberNames(self.numbers[index])
        return str(self.numbers[index])

    def __iter__(self) -> Iterator[str]:
        return map(str, self.numbers.tolist())

    def __eq__(self, other: object) -> bool:
        if isinstance(other, NumberNames):
            return np.array_equal(self.numbers, other.numbers)
        return NotImplemented

    def __hash__(self) -> int:
        return hash(self.numbers.tobytes())

    def __reduce__(self) -> tuple[type[NumberNames], tuple[IntArray]]:
        return NumberNames, (self.numbers,)
