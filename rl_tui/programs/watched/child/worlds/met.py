"""Numbers of states and actions of any kind, given as the program meets them."""

from __future__ import annotations

from collections.abc import Iterable
from enum import Enum
from typing import Any, Final

import numpy as np

from rl_tui.programs.watched.child.environments.numbering import Numbering

MOST_ACTIONS: Final = 64
MOST_STATES: Final = 16_384
"""Most states that are met."""
_LONGEST: Final = 32
"""Most numbers of an observation."""
Key = int | float | str | tuple[Any, ...]


class UnfitError(ValueError):
    """A state or an action that cannot be numbered. The text is the reason."""


def key_of(value: Any) -> Key:
    """Return the value that equal observations share, in plain Python. Raises UnfitError if there is none."""
    kind = type(value)
    if kind in (int, str):
        return value  # type: ignore[no-any-return]
    if kind in (bool, np.bool_):
        return int(value)
    if kind is float:
        return int(value) if value.is_integer() else value
    if kind in (tuple, list):
        return tuple([key_of(each) for each in value])
    if kind is np.ndarray:
        return key_of(value.tolist())
    if issubclass(kind, np.generic):
        return key_of(value.item())
    if issubclass(kind, Enum):
        return str(value)
    raise UnfitError(f"an observation is of the type {kind.__name__}")


def state_key(observation: Any) -> Key:
    """Return the key of an observation. Raises UnfitError if it is not one of few."""
    key = key_of(observation)
    parts = key if type(key) is tuple else (key,)
    if any(type(each) is float for each in parts):
        raise UnfitError("its observations are numbers with fractions")
    if len(parts) > _LONGEST:
        raise UnfitError(f"an observation has {len(parts):,} parts")
    return key


class FixedStates:
    """The states and actions of `numbering` as keys of a table."""

    def __init__(self, numbering: Numbering) -> None:
        self._numbering = numbering
        self.met = range(numbering.states)
        self.are_actions_places = numbering.first_action == 0

    def key(self, state: int) -> Any:
        """Return the observation of a state."""
        return self._numbering.key(state)

    def action_of_key(self, key: Any) -> int | None:
        """Return the number of the action that `key` of a table stands for, or None."""
        try:
            return self._numbering.action(key)
        except (TypeError, ValueError):
            return None

    def action_key(self, number: int) -> int:
        """Return the action with a number, as the program writes it."""
        return number + self._numbering.first_action


class MetNumbering(Numbering):
    """Numbers of the states in `observations`, and of later ones up to a limit. Actions are numbered from
    0, and whole numbers below `actions` are their own numbers. Observations may have fractions if
    `has_fractions`. `most` is the limit.
    """

    def __init__(
        self,
        observations: Iterable[Any],
        actions: int,
        *,
        has_fractions: bool = False,
        most: int = MOST_STATES,
    ) -> None:
        self._has_fractions = has_fractions
        self._numbers: dict[Key, int] = {}
        self._originals: list[Any] = []
        self._action_numbers: dict[Key, int] = {}
        self._actions: dict[int, Any] = {}
        known = {state_key(each): each for each in observations}
        are_sorted = len({type(each) for each in known}) == 1 and all(map(_has_order, known))
        for key in sorted(known) if are_sorted else known:
            self._add(key, known[key])
        super().__init__((most,), (0,), False, actions, 0)

    @property
    def met(self) -> range:
        """The numbers of all states met so far."""
        return range(len(self._originals))

    @property
    def are_actions_places(self) -> bool:
        """True if each action is its own number, so that it may be an index of a row."""
        return all(type(key) is int and key == number for key, number in self._action_numbers.items())

    def state(self, observation: Any) -> int:
        """Return the number of an observation. Raises UnfitError if it has none and gets none."""
        key = key_of(observation) if self._has_fractions else state_key(observation)
        found = self._numbers.get(key)
        if found is not None:
            return found
        if len(self._originals) >= self.states:
            raise UnfitError(f"more than {self.states:,} states were met")
        return self._add(key, observation)

    def action(self, action: Any) -> int:
        """Return the number of an action. Raises UnfitError if there are more than expected."""
        key = key_of(action)
        if type(key) is tuple and len(key) == 1:
            (key,) = key
        if key not in self._action_numbers:
            own = key if type(key) is int and 0 <= key < self.actions else None
            free = (each for each in range(self.actions) if each not in self._actions)
            number = own if own is not None and own not in self._actions else next(free, None)
            if number is None:
                raise UnfitError(f"more than {self.actions} actions were taken")
            self._action_numbers[key] = number
            self._actions[number] = action
        return self._action_numbers[key]

    def action_of_key(self, key: Any) -> int | None:
        """Return the number of the action that `key` of a table stands for, or None."""
        try:
            return self.action(key)
        except UnfitError:
            return None

    def action_key(self, number: int) -> Any:
        """Return the action with a number, as the program writes it."""
        return self._actions.get(number, number)

    def key(self, state: int) -> Any:
        """Return the observation of a state, or None if it was not met."""
        return self._originals[state] if state < len(self._originals) else None

    def place(self, state: int) -> tuple[int, ...]:
        """Return the state as an index."""
        return (state,)

    def _add(self, key: Key, observation: Any) -> int:
        number = self._numbers[key] = len(self._originals)
        self._originals.append(observation.copy() if type(observation) in (list, np.ndarray) else observation)
        return number


def _has_order(key: Key) -> bool:
    """Return True for whole numbers, and for tuples of them."""
    return type(key) is int or (type(key) is tuple and all(type(each) is int for each in key))
