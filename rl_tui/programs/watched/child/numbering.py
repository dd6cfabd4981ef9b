"""Observations and actions of an environment as numbers from 0."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from math import prod
from operator import index
from typing import Any

import gymnasium

Key = int | tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Numbering:
    """Of observations with parts of the sizes ``parts``, counting from ``first``; one for a plain number.

    Actions are ``actions`` numbers from ``first_action`` on.
    """

    parts: tuple[int, ...]
    first: tuple[int, ...]
    is_tuple: bool
    actions: int
    first_action: int

    @property
    def states(self) -> int:
        """How many observations there may be."""
        return prod(self.parts)

    @property
    def counts_from_0(self) -> bool:
        """Whether the number of a state is its observation."""
        return not self.is_tuple and self.first == (0,)

    def state(self, observation: Any) -> int:
        """Return the number of an observation: of a tuple its place in row-major order.

        Raises TypeError or ValueError where it is none of this environment.
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
        """Return the number of an action from 0. Raises TypeError or ValueError where there is none such."""
        try:
            number = index(action) - self.first_action
        except TypeError:  # an array of one number, which indexes as well
            if getattr(action, "shape", None) != (1,):
                raise
            number = int(action[0]) - self.first_action
        if 0 <= number < self.actions:
            return number
        raise ValueError("an action outside of its space")

    def place(self, state: int) -> tuple[int, ...]:
        """Return the place of a state in an array with a dimension for each part."""
        place = []
        for size in reversed(self.parts):
            state, part = divmod(state, size)
            place.append(part)
        return tuple(reversed(place))

    def key(self, state: int) -> Key:
        """Return the observation of a state, as a dict of the program would have it."""
        if not self.is_tuple:
            return state + self.first[0]
        return tuple(part + first for part, first in zip(self.place(state), self.first, strict=True))


@cache
def _numbering(*parts: Any) -> Numbering:
    """Return one and the same object for the same spaces, so that they are quickly compared."""
    return Numbering(*parts)


def numbering_of(env: gymnasium.Env[Any, Any]) -> Numbering | None:
    """Return how observations and actions are numbered; None where they are no finite numbers."""
    actions, observations = env.action_space, env.observation_space
    is_tuple = isinstance(observations, gymnasium.spaces.Tuple)
    parts = tuple(observations) if isinstance(observations, gymnasium.spaces.Tuple) else (observations,)
    discrete = [each for each in parts if isinstance(each, gymnasium.spaces.Discrete)]
    if not isinstance(actions, gymnasium.spaces.Discrete) or not parts or len(discrete) != len(parts):
        return None
    sizes, first = tuple(int(each.n) for each in discrete), tuple(int(each.start) for each in discrete)
    return _numbering(sizes, first, is_tuple, int(actions.n), int(actions.start))
