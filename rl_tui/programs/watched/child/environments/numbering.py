"""Observations and actions of an environment as numbers from 0."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from math import prod
from operator import index
from typing import Any

import gymnasium


@dataclass(unsafe_hash=True)
class Numbering:
    """Numbers of observations whose parts have the sizes `parts` from `first` on, and of actions. A plain
    number has one part.
    """

    parts: tuple[int, ...]
    first: tuple[int, ...]
    is_tuple: bool
    actions: int
    first_action: int

    def __post_init__(self) -> None:
        self.action_keys: list[Any] = list(range(self.first_action, self.first_action + self.actions))

    @property
    def met(self) -> range:
        """The known states."""
        return range(self.states)

    @property
    def are_actions_places(self) -> bool:
        """True if a row has the actions in their order."""
        return True

    @property
    def states(self) -> int:
        """Number of possible observations."""
        return prod(self.parts)

    @property
    def counts_from_0(self) -> bool:
        """True if states equal observations."""
        return not self.is_tuple and self.first == (0,)

    def state(self, observation: Any) -> int:
        """Return an observation's number, row-major. Raises TypeError or ValueError if invalid."""
        if not self.is_tuple:
            state = index(observation) - self.first[0]
            if 0 <= state < self.parts[0]:
                return state
            raise ValueError("the observation is outside its space")
        state = 0
        for each, size, first in zip(observation, self.parts, self.first, strict=True):
            place = index(each) - first
            if not 0 <= place < size:
                raise ValueError("the observation is outside its space")
            state = state * size + place
        return state

    def action(self, action: Any) -> int:
        """Return an action's number. Raises TypeError or ValueError if invalid."""
        try:
            number = index(action) - self.first_action
        except TypeError:  # an array of one number, which works as an index too
            if getattr(action, "shape", None) != (1,):
                raise
            number = int(action[0]) - self.first_action
        if 0 <= number < self.actions:
            return number
        raise ValueError("the action is outside its space")

    def action_of_key(self, key: Any) -> int | None:
        """Return the action of a table's `key`, or None."""
        try:
            return self.action(key)
        except (TypeError, ValueError):
            return None

    def place(self, state: int) -> tuple[Any, ...]:
        """Return a state's index in an array."""
        place = []
        for size in reversed(self.parts):
            state, part = divmod(state, size)
            place.append(part)
        return tuple(reversed(place))

    def key(self, state: int) -> Any:
        """Return a state's observation as a dict's key."""
        if not self.is_tuple:
            return state + self.first[0]
        return tuple(part + first for part, first in zip(self.place(state), self.first, strict=True))


@cache
def _numbering(*parts: Any) -> Numbering:
    """Return the same object for equal spaces, for quick comparison."""
    return Numbering(*parts)


def numbering_of(env: gymnasium.Env[Any, Any]) -> Numbering | None:
    """Return the numbers of observations and actions, if finite."""
    actions, observations = env.action_space, env.observation_space
    is_tuple = isinstance(observations, gymnasium.spaces.Tuple)
    parts = tuple(observations) if isinstance(observations, gymnasium.spaces.Tuple) else (observations,)
    discrete = [each for each in parts if isinstance(each, gymnasium.spaces.Discrete)]
    if not isinstance(actions, gymnasium.spaces.Discrete) or not parts or len(discrete) != len(parts):
        return None
    sizes, first = tuple(int(each.n) for each in discrete), tuple(int(each.start) for each in discrete)
    return _numbering(sizes, first, is_tuple, int(actions.n), int(actions.start))
