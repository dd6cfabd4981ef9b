"""The base of agents from Berkeley's course, with its names."""

# ruff: noqa: N802, N803

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from typing import Any


class Counter(dict[Any, float]):
    """A dict with 0 for missing keys."""

    def __missing__(self, key: Any) -> float:
        return 0.0

    def argMax(self) -> Any:
        """Return the first best key, or None if empty."""
        return max(self, key=self.__getitem__, default=None)


def flipCoin(p: float) -> bool:
    """Return True with probability `p`."""
    return random.random() < p


def raiseNotDefined() -> None:
    """Raise the error of an unfinished method."""
    raise NotImplementedError("a method of this agent is not written yet")


class ReinforcementAgent:
    """An agent that learns from experience."""

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
        """Return the available actions in `state`, () after the end."""
        return self.actionFn(state)

    def doAction(self, state: Any, action: int) -> None:
        """Ignore the action that is taken."""
