"""The interface of environments that can only be simulated."""

from __future__ import annotations

from typing import NamedTuple, Protocol

from rl_tui.common.errors import UserError


class StepResult(NamedTuple):
    """Next state, reward, and end of the episode."""

    next_state: int
    reward: float
    terminated: bool
    truncated: bool


class Environment(Protocol):
    """One environment for one run. States and actions are numbered from 0.

    Both methods raise :class:`EnvironmentFailedError` on failure, or for an invalid state or reward.
    """

    def reset(self, seed: int | None = None) -> int:
        """Start an episode and return its first state."""
        ...

    def step(self, action: int) -> StepResult:
        """Take `action` and return its result."""
        ...


class EnvironmentFailedError(UserError):
    """An environment failed, for a reason in one line."""
