"""An environment that is stepped for real because it has no transition table."""

from __future__ import annotations

from typing import NamedTuple, Protocol

from rl_tui.common.errors import UserError


class StepResult(NamedTuple):
    """The result of one action: the next state, the reward, and whether the episode is over."""

    next_state: int
    reward: float
    terminated: bool
    truncated: bool


class Environment(Protocol):
    """One copy of an environment, for one run. States and actions are numbers from 0, as in its space.

    Both methods raise :class:`EnvironmentFailedError` where the environment raises, or returns what is no
    state or no finite reward.
    """

    def reset(self, seed: int | None = None) -> int:
        """Begin an episode and return its first state; ``seed`` starts the environment's own randomness."""
        ...

    def step(self, action: int) -> StepResult:
        """Take ``action``."""
        ...


class EnvironmentFailedError(UserError):
    """The environment behind a world broke down; the message says how, in one line."""
