"""Observations and actions of an environment as numbers from 0."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from math import prod
from operator import index
from typing import Any

import gymnasium

Key = int | tuple[int, ...]


@dataclass(unsafe_hash=True)
class Numbering:
    """Numbers of observations whose parts have the sizes `parts` from `first` on (one part for a plain
    number), and of `actions` actions from `first_action` on.
    """

    parts: tuple[int, ...]
    first: tuple[int, ...]
    is_tuple: bool
    actions: int
    first_action: int

    @property
    def states(self) -> int:
        """Number of possible observations."""
        return prod(self.parts)

    @property
    def counts_from_0(self) -> bool:
        """True if the number of a state equals its observation."""
        return not self.is_tuple and self.first == (0,)

    def state(self, observation: Any) -> int:
        """Return the number of an observation, in row-major order for a tuple. Raises TypeError or
        ValueError for an invalid one.
        """
        if not self.is_tuple:
            state = index(observation) - self.first[0]
            if 0 <= state < self.parts[0]:
                return state
            raise ValueError("an observation outside of its space")
        state = 0
        for each, size, first in zip(observation, self.parts, self.first, strict=True):
            place = index(each) - first
            if not 0 <= place < size:
                raise ValueError("an observation outside of its space")
            state = state * size + place
        return state

    def action(self, action: Any) -> int:
        """Return the number of an action from 0. Raises TypeError or ValueError for an invalid one."""
        try:
            number = index(action) - self.first_action
        except TypeError:  # an array of one number, which works as an index too
            if getattr(action, "shape", None) != (1,):
                raise
            number = int(action[0]) - self.first_action
        if 0 <= number < self.actions:
            return number
        raise ValueError("an action outside of its space")

    def place(self, state: int) -> tuple[int, ...]:
        """Return the index of a state in an array with a dimension for each part."""
        place = []
        for size in reversed(self.parts):
            state, part = divmod(state, size)
            place.append(part)
        return tuple(reversed(place))

    def key(self, state: int) -> Key:
        """Return the observation of a state, as a dict of the program would use it."""
        if not self.is_tuple:
            return state + self.first[0]
        return tuple(part + first for part, first in zip(self.place(state), self.first, strict=True))


@cache
def _numbering(*parts: Any) -> Numbering:
    """Return the same object for equal spaces, for quick comparison."""
    return Numbering(*parts)


def numbering_of(env: gymnasium.Env[Any, Any]) -> Numbering | None:
    """Return the numbers of observations and actions, or None if they are not finite."""
    actions, observations = env.action_space, env.observation_space
    is_tuple = isinstance(observations, gymnasium.spaces.Tuple)
    parts = tuple(observations) if isinstance(observations, gymnasium.spaces.Tuple) else (observations,)
    discrete = [each for each in parts if isinstance(each, gymnasium.spaces.Discrete)]
    if not isinstance(actions, gymnasium.spaces.Discrete) or not parts or len(discrete) != len(parts):
        return None
    sizes, first = tuple(int(each.n) for each in discrete), tuple(int(each.start) for each in discrete)
    return _numbering(sizes, first, is_tuple, int(actions.n), int(actions.start))
