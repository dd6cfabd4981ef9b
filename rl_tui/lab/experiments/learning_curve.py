"""The mean learning curve of one run or many, in bins of equal width."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Final, NamedTuple

import numpy as np

from rl_tui.agents.kernels.episode_bins import CurveSums, collect
from rl_tui.agents.kernels.machine_code import fastest
from rl_tui.lab.experiments.training import Goal, OnProgress, no_progress, train
from rl_tui.lab.run.recipe import begin
from rl_tui.lab.run.run import Run
from rl_tui.worlds.drawing import Arms
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray

MOST_BINS: Final = 200


class CurvePoints(NamedTuple):
    """The curves of R runs in the same B bins, that end with episode ``last_episode``, [B].

    The mean return, the mean length and the share of optimal actions in each bin, [R, B].
    """

    last_episode: IntArray
    returns: FloatArray
    lengths: FloatArray
    optimal: FloatArray


def width_of_bins(episodes: int, most_bins: int = MOST_BINS) -> int:
    """Return of how many episodes each of at most ``most_bins`` bins of a curve is, which cover so many."""
    return math.ceil(episodes / most_bins)


class RunCurve:
    """The learning curve of one run over its first ``episodes`` episodes, at least one.

    It has at most ``most_bins`` bins. Call it with episodes as they are finished.
    """

    def __init__(self, episodes: int, most_bins: int = MOST_BINS) -> None:
        self.episodes = episodes
        self.width = width_of_bins(episodes, most_bins)
        bins = math.ceil(episodes / self.width)
        self.last_episode = np.minimum(np.arange(1, bins + 1) * self.width, episodes)
        self.sums = CurveSums(np.zeros(bins), np.zeros(bins, np.int64), np.zeros(bins, np.int64))
        self._done = 0

    def __call__(self, returns: FloatArray, lengths: IntArray, optimal: BoolArray) -> None:
        """Add the next episodes, [n] each; those beyond the end of the curve are left out."""
        part = slice(0, self.episodes - self._done)
        fastest(collect)(self.sums, self.width, self._done, returns[part], lengths[part], optimal[part])
        self._done = min(self.episodes, self._done + len(returns))

    @property
    def points(self) -> CurvePoints:
        """The curve, as that of one run."""
        count = np.diff(self.last_episode, prepend=0)
        returns, lengths, optimal = (sums[np.newaxis] / count for sums in self.sums)
        return CurvePoints(self.last_episode, returns, lengths, optimal)


def curve_of_run(
    run: Run, curve: RunCurve | None, on_progress: OnProgress = no_progress
) -> dict[str, list[Any]]:
    """Return the mean curve of ``run``, which is over, alone: that of ``curve``, if it was there to listen.

    Where it was not, since a number of steps says nothing of the width of the bins, the episodes are simply
    trained once more: the same recipe gives the same ones. The sweeps of a planner have no returns, and so
    no curve. Raises UserError as training does.
    """
    bandit, episodes = isinstance(run.world.drawing, Arms), run.learner.episodes
    if run.learner.plans or episodes == 0:
        return no_curve(bandit)
    if curve is None:
        curve = RunCurve(episodes)
        again = Run(run.recipe, begin(run.recipe), evaluate=False, on_episodes=curve)
        train(again, Goal(episodes=episodes), on_progress, run.journal)
    return mean_curve([curve.points], bandit)


def mean_curve(curves: Sequence[CurvePoints], bandit: bool) -> dict[str, list[Any]]:
    """Return the mean over the runs of ``curves``, of the same bins, as ``train --runs --json`` prints it.

    The standard errors are those of the runs' means in each bin, None where there is one run.
    """
    last_episodes, *parts = zip(*curves, strict=True)
    returns, lengths, optimal = map(np.concatenate, parts)
    curve: dict[str, list[Any]] = {
        "episode": last_episodes[0].tolist(),
        "return_mean": returns.mean(axis=0).tolist(),
        "return_stderr": _standard_errors(returns),
        "length_mean": lengths.mean(axis=0).tolist(),
        "length_stderr": _standard_errors(lengths),
    }
    if bandit:
        curve["optimal_action_rate"] = optimal.mean(axis=0).tolist()
        curve["optimal_action_stderr"] = _standard_errors(optimal)
    return curve


def _standard_errors(values: FloatArray) -> list[float] | list[None]:
    """Return the standard error of the mean over runs in each bin of ``values``, [runs, bins]."""
    runs, bins = values.shape
    if runs == 1:
        return [None] * bins
    errors: list[float] = (values.std(axis=0, ddof=1) / math.sqrt(runs)).tolist()
    return errors


def first_of(curves: Sequence[CurvePoints], runs: int) -> Sequence[CurvePoints]:
    """Return the curves of the first so many ``runs`` of ``curves``."""
    found = list[CurvePoints]()
    for points in curves:
        if runs > 0:
            parts = (part[:runs] for part in points[1:])
            found.append(CurvePoints(points.last_episode, *parts))
            runs -= len(points.returns)
    return found


def no_curve(bandit: bool) -> dict[str, list[Any]]:
    """Return the curve of runs of which one finished no episode."""
    return {name: [] for name in mean_curve([RunCurve(1).points], bandit)}
