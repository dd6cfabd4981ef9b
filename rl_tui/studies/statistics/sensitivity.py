"""How much an algorithm depends on settings tuned for each scenario."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rl_tui.worlds.mdp.space import FloatArray, IntArray


@dataclass(frozen=True, eq=False)
class Sensitivity:
    """The gain of tuning for each of S scenarios, in units of best − random.

    Attributes:
        value: `tuned` − `in_common`, too large with few runs, because the largest of several means is high by
            luck.
        held_out: The same without that luck: settings are chosen by one half of the seeds and scored by the
            other, then vice versa. It may be negative, or None if a setting has no run in a half.
        tuned: Mean score with the best settings of each scenario.
        in_common: Mean score with the settings that are best for all together.
        best: Indexes of the best settings, `[S]`.
        common: Index of the common settings.
        lost: Loss of each scenario with the common settings, `[S]`.
    """

    value: float
    held_out: float | None
    tuned: float
    in_common: float
    best: IntArray
    common: int
    lost: FloatArray


def sensitivity_of(values: FloatArray, random: FloatArray, best: FloatArray) -> Sensitivity | None:
    """Compute mean_s max_h g(s, h) − max_h mean_s g(s, h), or None without settings.

    Here g(s, h) is the mean over runs of (score − random) / (best − random). The method is by J. Adkins, M.
    Bowling and A. White, "A Method for Evaluating Hyperparameter Sensitivity in Reinforcement Learning",
    2024, but with exact scores of the random and the best policy.

    Args:
        values: Scores of the runs, `[S, H settings, N seeds]`, NaN for a missing run. A setting without a run
            in some scenario is ignored.
        random: Score of the random policy, `[S]`.
        best: Score of the best policy, `[S]`, below `random` for costs.

    Raises:
        ValueError: Shapes do not fit, or `random` equals `best` in a scenario.
    """
    if values.ndim != 3 or random.shape != best.shape or random.shape != values.shape[:1]:
        raise ValueError("expected a row of values, a random score and a best score for each scenario")
    ranges = best - random
    if not np.all(np.isfinite(ranges) & (ranges != 0)):
        raise ValueError("scores have no scale if the random policy is the best one")
    settings = np.flatnonzero(~np.isnan(values).all(axis=2).any(axis=0))
    if not settings.size or not random.size:
        return None
    runs = (values[:, settings] - random[:, np.newaxis, np.newaxis]) / ranges[:, np.newaxis, np.newaxis]
    scores, each = _means(runs), np.arange(random.size)
    own, common = _choices(scores)
    lost = scores[each, own] - scores[:, common]
    return Sensitivity(
        float(lost.mean()),
        _held_out(runs),
        float(scores[each, own].mean()),
        float(scores[:, common].mean()),
        settings[own],
        int(settings[common]),
        lost,
    )


def _means(runs: FloatArray) -> FloatArray:
    count = np.sum(~np.isnan(runs), axis=2)
    means = np.full(count.shape, np.nan)
    np.divide(np.nansum(runs, axis=2), count, out=means, where=count > 0)
    return means


def _choices(scores: FloatArray) -> tuple[IntArray, int]:
    return np.argmax(scores, axis=1), int(np.argmax(scores.mean(axis=0)))


def _held_out(runs: FloatArray) -> float | None:
    halves = _means(runs[:, :, ::2]), _means(runs[:, :, 1::2])
    if any(np.isnan(half).any() for half in halves):
        return None
    gains = []
    for by, scored in (halves, halves[::-1]):
        own, common = _choices(by)
        gains.append(float(np.mean(scored[np.arange(len(scored)), own] - scored[:, common])))
    return sum(gains) / 2
