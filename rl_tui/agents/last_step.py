"""The last step of a run, with every number that went into its update."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, NamedTuple

from rl_tui.agents.hyperparameters import Hyperparameters

NOTHING: Final = -1


class Author(NamedTuple):
    """Who took the last step: the algorithm and the hyper-parameters that were in force then."""

    algorithm: str
    hyperparameters: Hyperparameters


@dataclass(frozen=True, slots=True)
class LastStep:
    """One turn of the agent–environment loop and the update that followed.

    ``step`` and ``episode`` count from 1. ``outcome`` indexes the outcomes of the MDP: the pair's action is
    what was meant, outcome_action[outcome] what happened; it is −1 where the environment was stepped for
    real. ``epsilon`` is the ε of its episode, which means nothing to some policies. ``explored`` says of
    ε-greedy that the action was drawn at random (it may be the greedy one all the same), of other policies
    that it was not a greedy one.

    ``episode_step`` counts the steps of its episode, this one included. ``by_hand`` says that a person chose
    the action.

    A planner takes no step in the world: then ``pair`` is −1 as well, ``state`` is the one it backed up, and
    ``episode`` its sweep.

    The update moved ``updated_pair`` from ``before`` to ``after`` = before + step_size·(target − before), the
    target being gathered + discount·bootstrap: one-step methods gather the ``reward`` and discount by
    ``gamma``. The bootstrap is 0 after a terminated step, not after a truncated one. ``bootstrap_state`` is
    the state whose estimates it was read from, −1 for none and for a planner, which reads those of all that
    may follow. ``updated_pair`` is −1 where nothing was learned yet (n-step methods, Monte Carlo). ``others``
    counts further updates of the same step (traces, planning); ``table`` says which of two tables moved, 0
    where there is one.
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
        """Whether a planner took it, in its model and not in the world."""
        return self.pair == NOTHING

    @property
    def learned(self) -> bool:
        """Whether an estimate was updated."""
        return self.updated_pair != NOTHING

    @property
    def target(self) -> float:
        """What the update aims at: gathered + discount·bootstrap."""
        return self.gathered + self.discount * self.bootstrap

    @property
    def td_error(self) -> float:
        """δ: target − estimate before."""
        return self.target - self.before

    @property
    def error_sign(self) -> int:
        """1 where the update raised the estimate, −1 where it lowered it, else 0."""
        return (self.after > self.before) - (self.after < self.before)
