"""Regret and rewards of a bandit run (Sutton & Barto, 2nd ed., section 2.3)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP
from rl_tui.worlds.world import World

if TYPE_CHECKING:
    from rl_tui.agents.kernels.drift import Drifted


@dataclass(frozen=True, slots=True)
class BanditFigures:
    """Results of a bandit run so far."""

    pulls: int
    """Pulls so far."""
    budget: int
    """Pulls in all."""
    winnings: float
    """Sum of all rewards."""
    regret: float
    """Sum over all pulls of max q* − q*(pulled arm), exact."""
    best_arm_rate: float | None
    """Share of pulls on the best arm, 0 to 1, or None before the first pull."""
    best_possible: float
    """Expected sum of rewards if every pull took the best arm: pulls · max q*."""


class SettledPulls(NamedTuple):
    """Sums over the pulls before the last edit, with the means of that time."""

    pulls: int = 0
    regret: float = 0.0
    best_possible: float = 0.0
    best_pulls: int = 0
    visits: IntArray = np.zeros(1, np.int64)
    """Pulls of each current arm before the edit, `[P]`."""


NOTHING_SETTLED: Final = SettledPulls()


def true_means(mdp: TabularMDP) -> FloatArray:
    """Return q* of each arm, `[P]`."""
    return mdp.expected_reward


def best_arms(mdp: TabularMDP) -> BoolArray:
    """Mark the arms with the largest mean, `[P]`."""
    means = true_means(mdp)
    return np.asarray(means == means.max())


def bandit_figures(
    world: World,
    visits: IntArray,
    winnings: float,
    drifted: Drifted | None = None,
    settled: SettledPulls = NOTHING_SETTLED,
) -> BanditFigures | None:
    """Compute regret and related numbers, or None if `world` is not a bandit.

    `visits`, `[P]`, are pulls. `drifted` and `settled` are sums since and before the last edit.
    """
    if not world.is_bandit or world.mdp is None or world.budget is None:
        return None
    pulls, regret, best_possible, best_pulls, _ = settle(world.mdp, visits, settled, drifted)
    return BanditFigures(
        pulls=pulls,
        budget=world.budget,
        winnings=winnings,
        regret=regret,
        best_arm_rate=best_pulls / pulls if pulls else None,
        best_possible=best_possible,
    )


def settle(mdp: TabularMDP, visits: IntArray, before: SettledPulls, drifted: Drifted | None) -> SettledPulls:
    """Add the sums since the last edit (`drifted` if the means drift) to those `before` it."""
    since = visits - before.visits
    regret, best_possible, best_pulls = _by_their_means(mdp, since) if drifted is None else drifted
    return SettledPulls(
        before.pulls + int(since.sum()),
        before.regret + regret,
        before.best_possible + best_possible,
        before.best_pulls + best_pulls,
    )


def _by_their_means(mdp: TabularMDP, pulls: IntArray) -> tuple[float, float, int]:
    means = true_means(mdp)
    best = float(means.max())
    return float(np.dot(pulls, best - means)), best * int(pulls.sum()), int(pulls[means == best].sum())
