"""Checks which algorithms and policies work in a world."""

from __future__ import annotations

import numpy as np

from rl_tui.agents.catalogue import POLICY_BY_ID, algorithm_of
from rl_tui.agents.hyperparameters import Hyperparameters
from rl_tui.common.errors import UserError
from rl_tui.worlds.mdp.space import FiniteSpace
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP


def is_bandit(space: FiniteSpace) -> bool:
    """Return True if every step starts in the same state and ends the episode."""
    if not isinstance(space, TabularMDP) or not space.terminated.all():
        return False
    return int(np.count_nonzero(np.diff(space.first_pair))) == 1


def incompatibility(space: FiniteSpace, algorithm: str, hyperparameters: Hyperparameters) -> str:
    """Return why `algorithm` cannot work in `space`, with an alternative, or ""."""
    chosen = algorithm_of(algorithm)
    if chosen.planner:
        if isinstance(space, TabularMDP):
            return ""
        return (
            f"{chosen.name} plans with the transition table, and this environment has none: choose an "
            "algorithm that learns, such as q-learning"
        )
    policy = POLICY_BY_ID[hyperparameters.policy]
    if policy.bandits_only and not is_bandit(space):
        *others, last = (each.id for each in POLICY_BY_ID.values() if not each.bandits_only)
        return f"policy {policy.id} is for bandits: take {', '.join(others)} or {last} here"
    if policy.needs_step_size and hyperparameters.sample_average:
        return f"policy {policy.id} needs a step size: give a number for alpha, such as 0.1"
    return ""


def check_compatible(space: FiniteSpace, algorithm: str, hyperparameters: Hyperparameters) -> None:
    """Raise UserError if `algorithm` cannot work in `space`, with an alternative."""
    refused = incompatibility(space, algorithm, hyperparameters)
    if refused:
        raise UserError(refused)
