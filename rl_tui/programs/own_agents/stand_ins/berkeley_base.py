"""What agents of Berkeley's course build on: their base class, a dict of zeros, and a coin.

The names are those of the course.
"""

# ruff: noqa: N802, N803

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from typing import Any


class Counter(dict[Any, float]):
    """A dict in which what is not there is 0."""

    def __missing__(self, key: Any) -> float:
        return 0.0

    def argMax(self) -> Any:
        """Return the first key with the largest value, None where there is none."""
        return max(self, key=self.__getitem__, default=None)


def flipCoin(p: float) -> bool:
    """Return true with probability ``p``."""
    return random.random() < p


def raiseNotDefined() -> None:
    """Say that a method is still to be written."""
    raise NotImplementedError("a method of this agent is still to be written")


class ReinforcementAgent:
    """An agent that learns from what it experiences."""

    def __init__(
        self,
        actionFn: Callable[[Any], Sequence[int]] | None = None,
        numTraining: float = 100,
        epsilon: float = 0.5,
        alpha: float = 0.5,
        gamma: float = 1.0,
    ) -> None:
        self.actionFn: Callable[[Any], Sequence[int]] = actionFn or (lambda state: ())
        self.numTraining = int(numTraining)
        self.epsilon, self.alpha, self.discount = float(epsilon), float(alpha), float(gamma)

    def getLegalActions(self, state: Any) -> Sequence[int]:
        """Return the actions that can be taken in ``state``; () after the end."""
        return self.actionFn(state)

    def doAction(self, state: Any, action: int) -> None:
        """Hear which action is taken; nothing to do here."""
