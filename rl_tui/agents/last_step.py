"""The last step of a run, with every number in its update."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, NamedTuple

from rl_tui.agents.hyperparameters import Hyperparameters

NOTHING: Final = -1


class Author(NamedTuple):
    """Algorithm and settings of the last step."""

    algorithm: str
    hyperparameters: Hyperparameters


@dataclass(frozen=True, slots=True)
class LastStep:
    """One turn of the agent–environment loop, with its update.

    The target is gathered + discount · bootstrap, and after = before + step_size · (target − before). Steps
    and episodes count from 1.

    Args:
        episode: For a planner, the sweep.
        state: For a planner, the state backed up.
        pair: −1 for a planner.
        explored: True if the action was drawn at random (ε-greedy; it may still be greedy) or was not greedy
            (other policies).
        outcome: Index in the MDP; −1 without a transition table.
        truncated: True if the time limit stopped the episode.
        updated_pair: −1 if nothing was updated yet (n-step methods, Monte Carlo).
        others: Number of further updates of the step (traces, planning).
        table: 1 or 2; 0 for algorithms with one table.
        gathered: Sum of rewards in the target.
        discount: Factor of the bootstrap; γ for one-step methods.
        bootstrap: 0 after a terminated step, but not after a truncated one.
        by_hand: True if a person chose the action.
        bootstrap_state: −1 for none, and for planners, which read several.
    """

    step: int
    episode: int
    state: int
    pair: int
    explored: bool
    epsilon: float
    outcome: int
    reward: float
    next_state: int
    terminated: bool
    truncated: bool
    updated_pair: int
    others: int
    table: int
    before: float
    step_size: float
    gamma: float
    gathered: float
    discount: float
    bootstrap: float
    after: float
    episode_step: int = 0
    by_hand: bool = False
    bootstrap_state: int = NOTHING

    @property
    def planned(self) -> bool:
        """True for a planner's step."""
        return self.pair == NOTHING

    @property
    def learned(self) -> bool:
        """True if an estimate was updated."""
        return self.updated_pair != NOTHING

    @property
    def target(self) -> float:
        """Gathered + discount · bootstrap."""
        return self.gathered + self.discount * self.bootstrap

    @property
    def td_error(self) -> float:
        """TD error δ: target − before."""
        return self.target - self.before

    @property
    def error_sign(self) -> int:
        """1 if the estimate rose, −1 if it fell, else 0."""
        return (self.after > self.before) - (self.after < self.before)
