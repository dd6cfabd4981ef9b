"""How a bandit's budget was spent (Sutton & Barto, 2nd ed., section 2.3)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rl_tui.worlds.drawing import Arms
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP
from rl_tui.worlds.world import World

if TYPE_CHECKING:
    from rl_tui.agents.kernels.drift import Drifted


@dataclass(frozen=True, slots=True)
class BanditFigures:
    """How a bandit's budget was spent."""

    pulls: int
    """Pulls so far."""
    budget: int
    """Pulls there are in all."""
    winnings: float
    """The sum of all rewards."""
    regret: float
    """The sum over all pulls of max q* − q*(pulled arm), exact."""
    best_arm_rate: float | None
    """The share of pulls on the truly best arm, 0 to 1; None before the first pull."""
    best_possible: float
    """What as many pulls of the best arm bring on average: pulls · max q*."""


def true_means(mdp: TabularMDP) -> FloatArray:
    """Return the expected reward of each pair, [P]: q* of a bandit's arms."""
    return mdp.expected_reward


def best_arms(mdp: TabularMDP) -> BoolArray:
    """Mark the truly best arms of a bandit, [P]; several where means are equal."""
    means = true_means(mdp)
    return np.asarray(means == means.max())


def bandit_figures(
    world: World, visits: IntArray, winnings: float, drifted: Drifted | None = None
) -> BanditFigures | None:
    """Return what pulling each arm ``visits``, [P], times came to; None where ``world`` is no bandit.

    ``drifted`` has the sums over all pulls where the means drift.
    """
    if not isinstance(world.drawing, Arms) or world.mdp is None or world.budget is None:
        return None
    pulls = int(visits.sum())
    if drifted is not None:
        regret, best_possible, best_pulls = drifted
    else:
        means = true_means(world.mdp)
        best = float(means.max())
        regret, best_possible = float(np.dot(visits, best - means)), best * pulls
        best_pulls = int(visits[means == best].sum())
    return BanditFigures(
        pulls=pulls,
        budget=world.budget,
        winnings=winnings,
        regret=regret,
        best_arm_rate=best_pulls / pulls if pulls else None,
        best_possible=best_possible,
    )
