"""How much an algorithm depends on settings that were found for each scenario alone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rl_tui.worlds.mdp.space import FloatArray, IntArray


@dataclass(frozen=True, eq=False)
class Sensitivity:
    """What settings of its own are worth to each of S scenarios, in parts of best − random.

    ``value`` is ``tuned`` − ``in_common``: the mean over scenarios of the score with the best settings for
    each, less that of the settings which are best for all together. ``best``, [S], and ``common`` are their
    indices, ``lost``, [S], what each scenario loses by the common ones.

    The largest of several means is too high by luck, so ``value`` comes out too large where runs are few.
    ``held_out`` is without that luck: settings chosen by one half of the seeds and scored by the other, and
    the other way round, on average. It may be below 0, and is None if a setting has no run in one of the
    halves.
    """

    value: float
    held_out: float | None
    tuned: float
    in_common: float
    best: IntArray
    common: int
    lost: FloatArray


def sensitivity_of(values: FloatArray, random: FloatArray, best: FloatArray) -> Sensitivity | None:
    """Return how sensitive to its settings an algorithm is.

    ``values``, [S scenarios, H settings, N seeds], are the scores of its runs, NaN for one that is not there.
    Sensitivity = mean_s max_h g(s, h) − max_h mean_s g(s, h), where g(s, h) is the mean over runs of (score −
    random) / (best − random): J. Adkins, M. Bowling and A. White, "A Method for Evaluating Hyperparameter
    Sensitivity in Reinforcement Learning", 2024. They scale by percentiles of scores; here the uniformly
    random and the best policy of each scenario are known exactly, ``random`` and ``best``, [S]. It is 0 if
    the same settings are best everywhere, and always for one scenario. For costs ``best`` is the smaller one.

    A setting without any run in some scenario is left out everywhere; None if that leaves none.

    Raises ValueError if shapes do not fit, or if ``random`` is as good as ``best`` in a scenario.
    """
    if values.ndim != 3 or random.shape != best.shape or random.shape != values.shape[:1]:
        raise ValueError("values need a row for each scenario, and a random and a best score for each")
    ranges = best - random
    if not np.all(np.isfinite(ranges) & (ranges != 0)):
        raise ValueError("where the random policy is the best one, scores have no scale")
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
    """Return the mean of the runs that are there, NaN where none is."""
    count = np.sum(~np.isnan(runs), axis=2)
    means = np.full(count.shape, np.nan)
    np.divide(np.nansum(runs, axis=2), count, out=means, where=count > 0)
    return means


def _choices(scores: FloatArray) -> tuple[IntArray, int]:
    """Return the best settings for each scenario, and for all; of equal ones the first."""
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
