"""The states and actions of a finite MDP."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields
from typing import overload

import numpy as np
import numpy.typing as npt

IntArray = npt.NDArray[np.int64]
FloatArray = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class FiniteSpace:
    """S states, A named actions and P available state–action pairs.

    State s owns the pairs first_pair[s] .. first_pair[s+1], in the order of their actions. Arrays are
    immutable; writable ones are copied.

    Args:
        state_names: [S].
        action_names: [A].
        first_pair: [S+1].
        pair_action: [P].
        time_limit: Steps after which an episode is truncated; 0: none.
    """

    state_names: Sequence[str]
    action_names: tuple[str, ...]
    first_pair: IntArray
    pair_action: IntArray
    time_limit: int

    def __post_init__(self) -> None:
        for each in fields(self):
            value = getattr(self, each.name)
            if isinstance(value, np.ndarray) and (value.flags.writeable or value.base is not None):
                value = value.copy()
                value.flags.writeable = False
                object.__setattr__(self, each.name, value)

    @property
    def states(self) -> int:
        """S, including terminal states."""
        return len(self.state_names)

    @property
    def pairs(self) -> int:
        """P, the number of available pairs."""
        return len(self.pair_action)

    @property
    def pair_state(self) -> IntArray:
        """State of each pair, [P]."""
        return np.repeat(np.arange(self.states), np.diff(self.first_pair))

    def state_of(self, pair: int) -> int:
        """Return the state that owns `pair`."""
        return int(np.searchsorted(self.first_pair, pair, side="right")) - 1

    def pairs_of(self, state: int) -> range:
        """Return the pairs of `state`. Empty for a terminal state."""
        return range(int(self.first_pair[state]), int(self.first_pair[state + 1]))

    def pair_of(self, state: int, action: int) -> int | None:
        """Return a pair, or None if the action is not available."""
        return next((pair for pair in self.pairs_of(state) if self.pair_action[pair] == action), None)

    def pair_name(self, pair: int) -> str:
        """Return the names of state and action, such as ``6, left``."""
        return f"{self.state_names[self.state_of(pair)]}, {self.action_names[int(self.pair_action[pair])]}"


def all_pairs(state_names: Sequence[str], action_names: Sequence[str], time_limit: int) -> FiniteSpace:
    """Return a space with all actions in all states (time limit 0: none)."""
    states, actions = len(state_names), len(action_names)
    return FiniteSpace(
        state_names=state_names,
        action_names=tuple(action_names),
        first_pair=np.arange(0, states * actions + 1, actions, dtype=np.int64),
        pair_action=np.tile(np.arange(actions, dtype=np.int64), states),
        time_limit=time_limit,
    )


class NumberNames(Sequence[str]):
    """Names "3", "4", "7", … of rising numbers, [n], each made on access.

    Raises:
        ValueError: The numbers do not rise.
    """

    __slots__ = ("numbers",)

    def __init__(self, numbers: IntArray) -> None:
        if not bool(np.all(np.diff(numbers) > 0)):
            raise ValueError("state_names: expected increasing numbers")
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
