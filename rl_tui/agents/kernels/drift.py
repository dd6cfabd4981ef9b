"""The best arms of a bandit, even if means drift (Sutton & Barto, 2nd ed., section 2.5)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.random import Generator

from rl_tui.agents.compatibility import is_bandit
from rl_tui.agents.kernels.compiled import inlined
from rl_tui.agents.kernels.tables import Tables
from rl_tui.worlds.mdp.space import BoolArray, FiniteSpace, FloatArray, IntArray
from rl_tui.worlds.mdp.tabular_mdp import TabularMDP


class Drift(NamedTuple):
    """The best arms of a bandit, marked in `optimal`, [P], and sums since the last change of the world, [1]
    each.

    Current means and their drift are `mean` and `offset`, [P], empty without drift. The sums are the `regret`
    of all pulls, `best_total` of the best arm of each moment, and `optimal_pulls`.
    """

    optimal: BoolArray
    mean: FloatArray
    offset: FloatArray
    regret: FloatArray
    best_total: FloatArray
    optimal_pulls: IntArray


class Drifted(NamedTuple):
    """Sums over pulls; see :class:`Drift`."""

    regret: float
    best_total: float
    optimal_pulls: int


def drifted_by(drift: Drift) -> Drifted | None:
    """Return the sums, or None if no means drift."""
    if not len(drift.offset):
        return None
    return Drifted(float(drift.regret[0]), float(drift.best_total[0]), int(drift.optimal_pulls[0]))


def new_drift(space: FiniteSpace) -> Drift:
    """Return the drift before the first step."""
    optimal, mean, drifts = np.zeros(space.pairs, np.bool_), np.empty(0), False
    if isinstance(space, TabularMDP) and is_bandit(space):
        mean = space.expected_reward
        optimal = np.asarray(mean == mean.max())
        drifts = space.drift_std > 0.0
    if not drifts:
        mean = np.empty(0)
    return Drift(optimal, mean, np.zeros(len(mean)), np.zeros(1), np.zeros(1), np.zeros(1, np.int64))


@inlined
def drift_on(drift: Drift, tables: Tables, pair: int, generator: Generator) -> None:
    """Add the regret of `pair`, then let all means drift."""
    if len(drift.mean) > 0:
        best = 0
        for arm in range(len(drift.mean)):
            if drift.mean[arm] > drift.mean[best]:
                best = arm
        drift.regret[0] += drift.mean[best] - drift.mean[pair]
        drift.best_total[0] += drift.mean[best]
        drift.optimal_pulls[0] += drift.optimal[pair]
        highest = -np.inf
        for arm in range(len(drift.mean)):
            step = tables.drift_std * generator.standard_normal()
            drift.mean[arm] += step
            drift.offset[arm] += step
            highest = max(highest, drift.mean[arm])
        for arm in range(len(drift.mean)):
            drift.optimal[arm] = drift.mean[arm] == highest
