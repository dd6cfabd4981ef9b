"""Numbers of states and actions, given as the program meets them."""

from __future__ import annotations

from collections.abc import Iterable
from enum import Enum
from typing import Any, Final

import numpy as np

from rl_tui.programs.watched.child.environments.numbering import Numbering

MOST_ACTIONS: Final = 64
MOST_STATES: Final = 16_384
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


def parts_of(key: Key) -> tuple[Any, ...]:
    """Return the parts of a key, one for a plain value."""
    return key if type(key) is tuple else (key,)


def state_key(observation: Any) -> Key:
    """Return the key of one of few observations. Raises UnfitError for others."""
    key = key_of(observation)
    parts = parts_of(key)
    if any(type(each) is float for each in parts):
        raise UnfitError("its observations are numbers with fractions")
    if len(parts) > _LONGEST:
        raise UnfitError(f"an observation has {len(parts):,} parts")
    return key


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
            free = sorted({*range(self.actions)} - {*self._action_numbers.values()})
            if not free:
                raise UnfitError(f"more than {self.actions} actions were taken")
            number = key if type(key) is int and key in free else free[0]
            self._action_numbers[key], self.action_keys[number] = number, action
        return self._action_numbers[key]

    def key(self, state: int) -> Any:
        """Return a state's observation, if it was met."""
        return self._originals[state] if state < len(self._originals) else None

    def place(self, state: int) -> tuple[Any, ...]:
        """Return the parts of a state's observation."""
        return parts_of(key_of(self.key(state)))

    def _add(self, key: Key, observation: Any) -> int:
        number = self._numbers[key] = len(self._originals)
        self._originals.append(observation.copy() if type(observation) in (list, np.ndarray) else observation)
        return number


def _has_order(key: Key) -> bool:
    return type(key) is int or (type(key) is tuple and all(type(each) is int for each in key))
