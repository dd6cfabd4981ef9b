"""What a program is to stop at, looked at after each step."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final, NamedTuple

Row = Callable[[int], Sequence[float]]
"""The numbers of a state's row as they are now, NaN where it has none."""
_CHANGE: Final = 3  # numbers: cell, before, after


class StepSeen(NamedTuple):
    """The last step, with the changes that happened since: cell, before and after of each."""

    state: int
    action: int
    reward: float
    next_state: int
    episode: int
    changes: Sequence[float]


class StopConditions:
    """What ``said`` asks for, as messages.py has it."""

    def __init__(self, said: Mapping[str, Any], actions: int) -> None:
        self._actions = actions
        self._states = frozenset(said.get("states", ()))
        self._cells = frozenset(said.get("cells", ()))
        self._reward = bool(said.get("reward"))
        self._ends_left = said.get("episode_ends")
        self._episode = said.get("episode")
        self._value = said.get("value")
        self._policy = bool(said.get("policy"))

    def met_by(self, step: StepSeen, row: Row, *, is_end: bool) -> str | None:
        """Return the name of what ``step`` met, if anything; ``is_end``: its episode is over with it."""
        if step.next_state in self._states:
            return "states"
        if step.state * self._actions + step.action in self._cells:
            return "cells"
        if self._reward and step.reward != 0.0:
            return "reward"
        if self._ends_left is not None and is_end:
            self._ends_left -= 1
            if self._ends_left <= 0:
                return "episode_ends"
        if self._episode is not None and is_end and step.episode + 1 >= self._episode:
            return "episode"
        if self._value is not None and self._is_crossed(step.changes):
            return "value"
        return "policy" if self._policy and self._is_another_policy(step.changes, row) else None

    def _is_crossed(self, changes: Sequence[float]) -> bool:
        cell, threshold = self._value or (-1, 0.0)
        mine = [place for place in range(0, len(changes), _CHANGE) if changes[place] == cell]
        if not mine:
            return False
        before, after = _or_0(changes[mine[0] + 1]), _or_0(changes[mine[-1] + 2])
        return before != after and min(before, after) <= threshold <= max(before, after)

    def _is_another_policy(self, changes: Sequence[float], row: Row) -> bool:
        first_before: dict[int, float] = {}
        for place in range(0, len(changes), _CHANGE):
            first_before.setdefault(int(changes[place]), changes[place + 1])
        for state in {cell // self._actions for cell in first_before}:
            now = [_or_0(each) for each in row(state)]
            base = state * self._actions
            then = [_or_0(first_before.get(base + action, each)) for action, each in enumerate(now)]
            if _best(now) != _best(then):
                return True
        return False


def _or_0(number: float) -> float:
    return 0.0 if math.isnan(number) else number


def _best(numbers: Sequence[float]) -> list[int]:
    best = max(numbers)
    return [place for place, each in enumerate(numbers) if each == best]
