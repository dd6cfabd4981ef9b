"""Numbers of states and actions, given as the program meets them."""

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
    """A state or an action that cannot be numbered, with the reason."""


def key_of(value: Any) -> Key:
    """Return what equal observations share. Raises UnfitError if there is nothing."""
    kind = type(value)
    if kind in (int, str):
        return value  # type: ignore[no-any-return]
    if kind in (bool, np.bool_):
        return int(value)
    if kind is float:
        return int(value) if value.is_integer() else value
    if kind in (tuple, list) or (issubclass(kind, tuple) and hasattr(kind, "_fields")):
        return tuple([key_of(each) for each in (value if kind is list else tuple.__iter__(value))])
    if kind is np.ndarray:
        return key_of(value.tolist())
    if issubclass(kind, np.generic):
        return key_of(value.item())
    if issubclass(kind, Enum):
        return str(value)
    raise UnfitError(f"an observation has the type {kind.__name__}")


def state_key(observation: Any) -> Key:
    """Return the key of one of few observations. Raises UnfitError for others."""
    key = key_of(observation)
    parts = key if type(key) is tuple else (key,)
    if any(type(each) is float for each in parts):
        raise UnfitError("its observations are numbers with fractions")
    if len(parts) > _LONGEST:
        raise UnfitError(f"an observation has {len(parts):,} parts")
    return key


class FixedStates:
    """States and actions of `numbering` as keys of a table."""

    def __init__(self, numbering: Numbering) -> None:
        self._numbering = numbering
        self.met = range(numbering.states)
        self.are_actions_places = numbering.first_action == 0

    def key(self, state: int) -> Any:
        """Return a state's observation."""
        return self._numbering.key(state)

    def action_of_key(self, key: Any) -> int | None:
        """Return the action of a table's `key`, or None."""
        try:
            return self._numbering.action(key)
        except (TypeError, ValueError):
            return None

    def action_key(self, number: int) -> int:
        """Return the action as the program writes it."""
        return number + self._numbering.first_action


class MetNumbering(Numbering):
    """Numbers of the states in `observations`, and of later ones up to `most`.

    Whole numbers below `actions` are their own numbers. Observations may have fractions if `has_fractions`.
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
        """The states met so far."""
        return range(len(self._originals))

    @property
    def are_actions_places(self) -> bool:
        """True if actions may index a row."""
        return all(type(key) is int and key == number for key, number in self._action_numbers.items())

    def state(self, observation: Any) -> int:
        """Return an observation's number. Raises UnfitError if it gets none."""
        key = key_of(observation) if self._has_fractions else state_key(observation)
        found = self._numbers.get(key)
        if found is not None:
            return found
        if len(self._originals) >= self.states:
            raise UnfitError(f"more than {self.states:,} states were seen")
        return self._add(key, observation)

    def action(self, action: Any) -> int:
        """Return an action's number. Raises UnfitError if there are too many."""
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
        """Return the action of a table's `key`, or None."""
        try:
            return self.action(key)
        except UnfitError:
            return None

    def action_key(self, number: int) -> Any:
        """Return the action as the program writes it."""
        return self._actions.get(number, number)

    def key(self, state: int) -> Any:
        """Return a state's observation, if it was met."""
        return self._originals[state] if state < len(self._originals) else None

    def place(self, state: int) -> tuple[int, ...]:
        """Return the state as an index."""
        return (state,)

    def _add(self, key: Key, observation: Any) -> int:
        number = self._numbers[key] = len(self._originals)
        self._originals.append(observation.copy() if type(observation) in (list, np.ndarray) else observation)
        return number


def _has_order(key: Key) -> bool:
    return type(key) is int or (type(key) is tuple and all(type(each) is int for each in key))
