"""Steps, states and actions of a world, from its first steps."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from types import FrameType
from typing import Any, Final, NamedTuple

import gymnasium
import numpy as np

from rl_tui.programs.watched.child.environments.numbering import Numbering
from rl_tui.programs.watched.child.tables.forms import MOST_CELLS
from rl_tui.programs.watched.child.tables.keyed_table import KeyShape, shape_of
from rl_tui.programs.watched.child.tables.search import GOOD, LIKE_Q, NO_TABLE, Way, rank, ways
from rl_tui.programs.watched.child.worlds.met import (
    MOST_ACTIONS,
    Key,
    UnfitError,
    key_of,
    parts_of,
    state_key,
)
from rl_tui.programs.watched.messages import StepFlag

FEW_STEPS: Final = 100
"""Number of first steps after which the known states get numbers."""
_COUNTS: Final = (
    *("n_actions", "nA", "num_actions", "action_size", "action_space_size", "n_action", "action_dim"),
)
_LISTS: Final = ("actions", "action_space", "actionSpace", "possibleActions", "possible_actions", "ACTIONS")
_LARGEST_KEPT: Final = 100_000
"""Most numbers of an array that is compared with itself one step later."""


class OwnStep(NamedTuple):
    """The result of a step. An end of `is_of_gymnasium` is not a limit."""

    observation: Any
    reward: float
    flags: int
    is_of_gymnasium: bool


class HeldStep(NamedTuple):
    """A step from `before`, as step `place` of its episode."""

    before: Any
    action: Any
    step: OwnStep
    place: int


def step_of(result: Any) -> OwnStep | None:
    """Return the step in (observation, reward, done, ...), if any."""
    if type(result) not in (tuple, list) or not 3 <= len(result) <= 5:
        return None
    observation, reward, done, *more = result
    is_reward = type(reward) in (int, float) or issubclass(type(reward), np.number)
    is_flag = type(done) in (bool, np.bool_) or (type(done) is int and done in (0, 1))
    if not (is_reward and is_flag) or observation is None or type(observation) in (bool, np.bool_):
        return None
    is_of_gymnasium = len(result) == 5 and type(more[0]) in (bool, np.bool_)
    is_truncated = bool(more[0]) if is_of_gymnasium else False
    if more and isinstance(more[-1], dict) and more[-1].get("TimeLimit.truncated"):
        done, is_truncated = False, True
    flags = (StepFlag.TERMINATED if done else 0) | (StepFlag.TRUNCATED if is_truncated else 0)
    return OwnStep(observation, float(reward), int(flags), is_of_gymnasium)


def function_step_of(result: Any, before: Key) -> OwnStep | None:
    """Return the step in (next state, reward, ...), if any. Only a flag after them ends it."""
    if type(result) not in (tuple, list) or not 2 <= len(result) <= 4:
        return None
    after, reward, *more = result
    try:
        is_state = type(state_key(after)) in (type(before), str)
    except UnfitError:
        return None
    is_reward = type(reward) in (int, float) or issubclass(type(reward), np.number)
    if not (is_state and is_reward):
        return None
    done = bool(more) and type(more[0]) in (bool, np.bool_) and bool(more[0])
    return OwnStep(after, float(reward), int(StepFlag.TERMINATED if done else 0), False)


def number_of_actions(cls: type, attributes: Mapping[str, Any]) -> int | None:
    """Return the number of actions that a world declares, or None."""
    for scope in (attributes, *(vars(each) for each in cls.__mro__[:-1])):
        space = scope.get("action_space")
        if isinstance(space, gymnasium.spaces.Discrete):
            return int(space.n)
        numbers = [scope.get(name) for name in _COUNTS]
        lists: list[Any] = [scope.get(name) for name in _LISTS]
        action = scope.get("action")
        lists += [action] if type(action) is list and all(type(each) is str for each in action) else []
        numbers += [len(each) for each in lists if type(each) in (list, tuple, dict, range)]
        for each in numbers:
            if type(each) is int and 2 <= each <= MOST_ACTIONS:
                return each
    return None


class TableSearch:
    """Finds the table of a world without spaces."""

    def __init__(self) -> None:
        self._before: dict[int, tuple[Any, Any]] = {}

    def array(
        self, frame: FrameType, observation: Any, action: Any, actions: int | None, last: HeldStep | None
    ) -> Numbering | None:
        """Return the numbering of an array with a cell for `observation` and `action`, or None.

        It is the table because of its name, or because `last`, the step before, has changed its own cell.
        Raises UnfitError if no table can have such rows.
        """
        key, taken = state_key(observation), key_of(action)
        parts = (*parts_of(key), taken)
        if not all(type(each) is int for each in parts):
            return None
        found = [
            (way, value)
            for way, value, sizes in _arrays(frame, len(parts))
            if all(0 <= each < size for each, size in zip(parts, sizes, strict=True))
            and actions in (None, sizes[-1])
            and (self._is_named(way, value) or self._has_learned(value, last))
        ]
        if not found:
            return None
        _, best = min(found, key=lambda each: rank(each[0].names[-1], each[1]))
        *states, width = np.shape(best)
        return Numbering(tuple(states), (0,) * len(states), type(key) is tuple, width, 0)

    def width(self, frame: FrameType | None, observations: Sequence[Any]) -> int | None:
        """Return the number of actions of a table with rows for `observations`."""
        for way, value in ways(frame):
            if not NO_TABLE.search(way.names[-1]):
                try:
                    found = shape_of(value, observations[-8:])
                except (LookupError, TypeError, ValueError, AttributeError, UnfitError):
                    continue
                if found is not None and found.shape not in (KeyShape.ARRAY, KeyShape.LISTS):
                    return found.actions
        return None

    @staticmethod
    def _is_named(way: Way, value: Any) -> bool:
        name = way.names[-1]
        is_real = type(value) is list or value.dtype.kind == "f"
        return bool(LIKE_Q.search(name)) or (is_real and bool(GOOD.search(name)))

    def _has_learned(self, value: Any, last: HeldStep | None) -> bool:
        if np.size(value) > _LARGEST_KEPT:
            return False
        now = np.array(value, np.float64)
        known, before = self._before.get(id(value), (None, None))
        self._before[id(value)] = value, now
        if known is not value or before.shape != now.shape or last is None:
            return False
        try:
            key, action = key_of(last.before), key_of(last.action)
        except UnfitError:
            return False
        cell = (*parts_of(key), action)
        changed = np.argwhere(before != now).tolist()
        return changed == [list(cell)]


def _arrays(frame: FrameType, dimensions: int) -> Iterator[tuple[Way, Any, tuple[int, ...]]]:
    for way, value in ways(frame):
        if type(value) not in (np.ndarray, list) or NO_TABLE.search(way.names[-1]):
            continue
        if type(value) is list and not (value and type(value[0]) in (list, np.ndarray)):
            continue
        try:
            array = np.asarray(value)
        except ValueError:
            continue
        is_table = array.ndim == dimensions and array.dtype.kind in "fiu"
        if is_table and 2 <= array.shape[-1] <= MOST_ACTIONS and array.size <= MOST_CELLS:
            yield way, value, array.shape
