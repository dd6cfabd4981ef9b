"""How a bandit's budget was spent (Sutton & Barto, 2nd ed., section 2.3)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NamedTuple

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


class SettledPulls(NamedTuple):
    """What the pulls came to that were taken before the arms last became others, each by its own means."""

    pulls: int = 0
    regret: float = 0.0
    best_possible: float = 0.0
    best_pulls: int = 0
    visits: IntArray = np.zeros(1, np.int64)
    """How often each arm of now had been pulled by then, [P]."""


NOTHING_SETTLED: Final = SettledPulls()


def true_means(mdp: TabularMDP) -> FloatArray:
    """Return the expected reward of each pair, [P]: q* of a bandit's arms."""
    return mdp.expected_reward


def best_arms(mdp: TabularMDP) -> BoolArray:
    """Mark the truly best arms of a bandit, [P]; several where means are equal."""
    means = true_means(mdp)
    return np.asarray(means == means.max())


def bandit_figures(
    world: World,
    visits: IntArray,
    winnings: float,
    drifted: Drifted | None = None,
    settled: SettledPulls = NOTHING_SETTLED,
) -> BanditFigures | None:
    """Return what pulling each arm ``visits``, [P], times came to; None where ``world`` is no bandit.

    ``settled`` are the pulls of other means, ``drifted`` has the sums over those since, where means drift.
    """
    if not isinstance(world.drawing, Arms) or world.mdp is None or world.budget is None:
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
    """Return what pulling each arm of ``mdp`` ``visits``, [P], times came to, some of them ``before``.

    Where means drift, ``drifted`` has what the others came to.
    """
    since = visits - before.visits
    regret, best_possible, best_pulls = _by_their_means(mdp, since) if drifted is None else drifted
    return SettledPulls(
        before.pulls + int(since.sum()),
        before.regret + regret,
        before.best_possible + best_possible,
        before.best_pulls + best_pulls,
    )


def _by_their_means(mdp: TabularMDP, pulls: IntArray) -> tuple[float, float, int]:
    """Return regret, best total and best pulls of ``pulls`` of each arm, [P], whose means stand still."""
    means = true_means(mdp)
    best = float(means.max())
    return float(np.dot(pulls, best - means)), best * int(pulls.sum()), int(pulls[means == best].sum())
