"""The last step of a run, with every number in its update."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, NamedTuple

from rl_tui.agents.hyperparameters import Hyperparameters

NOTHING: Final = -1


class Author(NamedTuple):
    """The algorithm and the settings that took the last step."""

    algorithm: str
    hyperparameters: Hyperparameters


@dataclass(frozen=True, slots=True)
class LastStep:
    """One turn of the agent–environment loop, with its update.

    The target of the update is gathered + discount · bootstrap, and after = before + step_size · (target −
    before).

    Args:
        step: Number of the step, from 1.
        episode: Number of the episode, from 1. For a planner: of the sweep.
        state: State before the step. For a planner: the state backed up.
        pair: Pair taken; −1 for a planner.
        explored: True if the action was drawn at random (ε-greedy; it may still be greedy) or was not greedy
            (other policies).
        epsilon: ε of the episode. Some policies ignore it.
        outcome: Index of the outcome in the MDP; −1 without a transition table.
        reward: The reward.
        next_state: State after the step.
        terminated: True if the episode ended in a terminal state.
        truncated: True if the time limit stopped the episode.
        updated_pair: Updated pair; −1 if nothing was updated yet (n-step methods, Monte Carlo).
        others: Number of further updates of the same step (traces, planning).
        table: Updated table, 1 or 2; 0 for algorithms with one table.
        before: Estimate before the update.
        step_size: Step size of the update.
        gamma: Discount γ.
        gathered: Sum of rewards in the target; the reward for one-step methods.
        discount: Factor of the bootstrap; γ for one-step methods.
        bootstrap: Estimate in the target; 0 after a terminated step, but not after a truncated one.
        after: Estimate after the update.
        episode_step: Number of the step in its episode, from 1.
        by_hand: True if a person chose the action.
        bootstrap_state: State of the bootstrap; −1 for none, and for planners, which read several.
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
        """True if a planner took the step in its model."""
        return self.pair == NOTHING

    @property
    def learned(self) -> bool:
        """True if an estimate was updated."""
        return self.updated_pair != NOTHING

    @property
    def target(self) -> float:
        """Target of the update: gathered + discount · bootstrap."""
        return self.gathered + self.discount * self.bootstrap

    @property
    def td_error(self) -> float:
        """TD error δ: target − estimate before."""
        return self.target - self.before

    @property
    def error_sign(self) -> int:
        """1 if the estimate rose, −1 if it fell, else 0."""
        return (self.after > self.before) - (self.after < self.before)
