"""The states and actions of a finite MDP, with or without its transition table."""

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
    """S states, A named actions and P legal state–action pairs.

    State s owns the pairs first_pair[s] .. first_pair[s+1], in the order of their actions; ``pair_action``,
    [P], says which of the A actions a pair is. ``time_limit`` is the number of steps after which an episode
    is truncated (0: none). Arrays never change: those that are writable elsewhere are copied.
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
        """S, the number of states, terminal ones included."""
        return len(self.state_names)

    @property
    def pairs(self) -> int:
        """P, the number of legal state–action pairs."""
        return len(self.pair_action)

    @property
    def pair_state(self) -> IntArray:
        """The state of each pair, [P]."""
        return np.repeat(np.arange(self.states), np.diff(self.first_pair))

    def state_of(self, pair: int) -> int:
        """Return the state that owns ``pair``."""
        return int(np.searchsorted(self.first_pair, pair, side="right")) - 1

    def pairs_of(self, state: int) -> range:
        """Return the pairs that ``state`` owns; empty for a terminal state."""
        return range(int(self.first_pair[state]), int(self.first_pair[state + 1]))

    def pair_of(self, state: int, action: int) -> int | None:
        """Return the pair of ``state`` and ``action``, None where that action is not legal there."""
        return next((pair for pair in self.pairs_of(state) if self.pair_action[pair] == action), None)

    def pair_name(self, pair: int) -> str:
        """Return the names of state and action of ``pair``, such as ``6, left``."""
        return f"{self.state_names[self.state_of(pair)]}, {self.action_names[int(self.pair_action[pair])]}"


def all_pairs(state_names: Sequence[str], action_names: Sequence[str], time_limit: int) -> FiniteSpace:
    """Return the space in which every action is legal in every state, as Gymnasium's environments have it."""
    states, actions = len(state_names), len(action_names)
    return FiniteSpace(
        state_names=state_names,
        action_names=tuple(action_names),
        first_pair=np.arange(0, states * actions + 1, actions, dtype=np.int64),
        pair_action=np.tile(np.arange(actions, dtype=np.int64), states),
        time_limit=time_limit,
    )


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
