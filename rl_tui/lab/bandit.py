"""How a bandit's budget was spent (Sutton & Barto, 2nd ed., section 2.3)."""

from __future__ import annotations

import numpy as np

from rl_tui.lab.snapshot import BanditFigures
from rl_tui.worlds.drawing import Arms
from rl_tui.worlds.mdp import BoolArray, FloatArray, IntArray, TabularMDP
from rl_tui.worlds.world import World


def true_means(mdp: TabularMDP) -> FloatArray:
    """Return the expected reward of each pair, [P]: q* of a bandit's arms."""
    means: FloatArray = np.add.reduceat(mdp.probability * mdp.reward, mdp.first_outcome[:-1])
    return means


def best_arms(mdp: TabularMDP) -> BoolArray:
    """Mark the truly best arms of a bandit, [P]; several where means are equal."""
    means = true_means(mdp)
    return np.asarray(means == means.max())


def bandit_figures(world: World, visits: IntArray, winnings: float) -> BanditFigures | None:
    """Return what pulling each arm ``visits``, [P], times came to; None where ``world`` is no bandit."""
    if not isinstance(world.drawing, Arms) or world.budget is None:
        return None
    means = true_means(world.mdp)
    pulls = int(visits.sum())
    best = float(means.max())
    return BanditFigures(
        pulls=pulls,
        budget=world.budget,
        winnings=winnings,
        regret=float(np.dot(visits, best - means)),
        best_arm_rate=int(visits[means == best].sum()) / pulls if pulls else None,
        best_possible=best * pulls,
    )
