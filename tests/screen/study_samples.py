"""Studies of many seeds, made by hand."""

from __future__ import annotations

from typing import Any

import numpy as np

from rl_tui.studies.many_seeds.figures import (
    Estimate,
    LaneStudy,
    PairedDifference,
    SeedCurve,
    SeedStudy,
    StudyState,
)


def seed_curve(low: float, high: float, bins: int = 40, width: int = 50, stderr: float = 0.02) -> SeedCurve:
    rise = 1.0 - np.exp(-np.arange(bins) / max(1.0, bins / 4))
    episode = np.arange(1, bins + 1, dtype=np.int64) * width
    return SeedCurve(episode, low + (high - low) * rise, np.full(bins, stderr))


def difference(mean: float, stderr: float, greater: int, equal: int = 0, count: int = 64) -> PairedDifference:
    return PairedDifference(Estimate(mean, stderr, count), greater, equal)


def lake_study(**changes: Any) -> SeedStudy:
    """64 of 256 seeds of the slippery lake, 500 episodes each. The exact return belongs to this seed."""
    lane = LaneStudy(
        {"return_last_100": Estimate(0.402, 0.0104, 64), "expected_return": Estimate(0.71, 0.006, 64)},
        {"return_last_100": 0.41, "expected_return": 0.73},
        curve=seed_curve(0.0, 0.4, width=312),
    )
    return _study({"lanes": (lane,)}, changes)


def cliff_study(**changes: Any) -> SeedStudy:
    q_learning = LaneStudy(
        {"return_last_100": Estimate(-47.1, 0.5, 64), "expected_return": Estimate(-13.0, 0.0, 60)},
        {"return_last_100": -43.0, "expected_return": -13.0},
        {"return_last_100": difference(22.5, 0.6, 64), "expected_return": difference(-4.0, 0.06, 0, 3)},
        seed_curve(-100.0, -47.0),
    )
    sarsa = LaneStudy(
        {"return_last_100": Estimate(-24.6, 0.4, 64), "expected_return": Estimate(-17.0, 0.06, 64)},
        {"return_last_100": -22.0, "expected_return": -17.0},
        curve=seed_curve(-100.0, -24.0),
    )
    return _study({"lanes": (q_learning, sarsa), "shown": 1}, changes)


def bandit_study(**changes: Any) -> SeedStudy:
    names = ("winnings", "regret", "best_arm_rate", "return_last_100", "expected_return")
    means = ((1402.0, 146.0, 0.79, 1.42, 1.51), (1303.0, 245.0, 0.72, 1.39, 1.44))
    errors = ((9.0, 2.0, 0.02, 0.02, 0.03), (11.0, 11.0, 0.02, 0.03, 0.04))
    own = ((1388.0, 186.0, 0.71, 1.31, 1.5), (1419.0, 161.0, 0.84, 1.45, 1.5))
    ucb, greedy = (
        LaneStudy(
            {name: Estimate(m, e, 64) for name, m, e in zip(names, mean, error, strict=True)},
            dict(zip(names, this, strict=True)),
            curve=seed_curve(0.0, mean[3], width=25),
        )
        for mean, error, this in zip(means, errors, own, strict=True)
    )
    apart = {
        "winnings": difference(99.0, 11.0, 58),
        "regret": difference(-99.0, 11.0, 3, 1),
        "best_arm_rate": difference(0.07, 0.025, 44),
        "return_last_100": difference(0.03, 0.03, 34),
        "expected_return": difference(0.07, 0.04, 20, 33),
    }
    lanes = (ucb, LaneStudy(greedy.estimates, greedy.this_seed, apart, greedy.curve))
    return _study({"lanes": lanes, "episodes": 1_000}, changes)


def _study(own: dict[str, Any], changes: dict[str, Any]) -> SeedStudy:
    usual: dict[str, Any] = {"state": StudyState.RUNNING, "seeds": 64, "most": 256, "episodes": 500}
    return SeedStudy(**(usual | own | changes))
