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
    """

    value: float
    tuned: float
    in_common: float
    best: IntArray
    common: int
    lost: FloatArray


def sensitivity_of(scores: FloatArray, random: FloatArray, best: FloatArray) -> Sensitivity | None:
    """Return how sensitive to its settings an algorithm is that scores ``scores``, [S scenarios, H settings].

    Sensitivity = mean_s max_h g(s, h) − max_h mean_s g(s, h), with g = (score − random) / (best − random):
    J. Adkins, M. Bowling and A. White, "A Method for Evaluating Hyperparameter Sensitivity in Reinforcement
    Learning", 2024. They scale by percentiles of scores; here the uniformly random and the best policy of
    each scenario are known exactly, ``random`` and ``best``, [S]. It is 0 if the same settings are best
    everywhere, and always for one scenario. For costs ``best`` is the smaller one.

    A setting without a score in some scenario, NaN, is left out everywhere; None if that leaves none. Scores
    are means of runs, and the largest of several is too high by luck: with few runs the value comes out too
    large.

    Raises ValueError if shapes do not fit, or if ``random`` is as good as ``best`` in a scenario.
    """
    if scores.ndim != 2 or random.shape != best.shape or random.shape != scores.shape[:1]:
        raise ValueError("scores need a row for each scenario, and a random and a best one for each")
    ranges = best - random
    if not np.all(np.isfinite(ranges) & (ranges != 0)):
        raise ValueError("where the random policy is the best one, scores have no scale")
    settings = np.flatnonzero(~np.isnan(scores).any(axis=0))
    if not settings.size or not random.size:
        return None
    scaled = (scores[:, settings] - random[:, np.newaxis]) / ranges[:, np.newaxis]
    own, common = np.argmax(scaled, axis=1), int(np.argmax(scaled.mean(axis=0)))
    tuned = scaled.max(axis=1)
    lost = tuned - scaled[:, common]
    return Sensitivity(
        float(lost.mean()),
        float(tuned.mean()),
        float(scaled[:, common].mean()),
        settings[own],
        int(settings[common]),
        lost,
    )
