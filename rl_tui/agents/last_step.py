"""The last step of a run, with every number that went into its update."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class LastStep:
    """One turn of the agent–environment loop and the update that followed.

    ``step`` and ``episode`` count from 1. ``outcome`` indexes the outcomes of the MDP: the pair's action is
    what was meant, outcome_action[outcome] what happened. ``explored`` says that the action was drawn at
    random with probability ``epsilon`` (it may be the greedy one all the same).

    The update moved ``updated_pair`` from ``before`` to ``after`` = before + step_size·(target − before), the
    target being reward + gamma·bootstrap. The bootstrap is 0 after a terminated step, not after a truncated
    one.
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
    before: float
    step_size: float
    gamma: float
    bootstrap: float
    after: float

    @property
    def target(self) -> float:
        """What the update aims at: reward + γ·bootstrap."""
        return self.reward + self.gamma * self.bootstrap

    @property
    def td_error(self) -> float:
        """δ: target − estimate before."""
        return self.target - self.before
