"""Expected SARSA: a target with the mean over an ε-greedy policy, so three numbers to solve for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Final

import numpy as np

from rl_tui.lab.detective.updates.pair_solving import drawn, most_frequent, plainest
from rl_tui.lab.detective.updates.sample import EXACT, Sample
from rl_tui.lab.detective.updates.trial import FEWEST, Trial
from rl_tui.lab.detective.verdict import UpdateTarget
from rl_tui.worlds.mdp.space import FloatArray, IntArray

_SINGULAR: Final = 1e-5


def expected_trial(sample: Sample, numbers: Mapping[str, float]) -> Trial | None:
    """Return Expected SARSA with the α, γ and ε that explain most steps, or None where nothing tells them."""
    inner = np.flatnonzero((sample.change != 0.0) & ~sample.ended)
    mean = sample.value(UpdateTarget.EXPECTED)
    telling = inner[np.abs(sample.best - mean)[inner] > 100 * sample.slack[inner]]
    if len(telling) < FEWEST:
        return None
    triples = np.column_stack((drawn(telling, 2), drawn(telling, 3), drawn(inner, 4)))
    digits = 6 if sample.evidence.precision < EXACT else 3
    trials = []
    for a, gamma, epsilon in most_frequent(_solved(sample, mean, triples), digits, 3):
        if 0.0 < epsilon <= 1.0 + 1e-6 and a != 0.0:
            trials.append(_with(sample, mean, (a, gamma, epsilon), numbers))
    neighbours = np.column_stack((telling[:-2], telling[1:-1], telling[2:]))
    episode = sample.evidence.episode[sample.at]
    neighbours = neighbours[episode[neighbours[:, 0]] == episode[neighbours[:, 2]]]
    for a, gamma in most_frequent(_solved(sample, mean, neighbours)[:, :2], digits, 2):
        if a != 0.0 and gamma != 0.0:
            trials.append(_with_own_epsilons(sample, mean, a, gamma, numbers))
    return min(trials, key=lambda trial: trial.unexplained, default=None)


def _solved(sample: Sample, mean: FloatArray, triples: IntArray) -> FloatArray:
    """Return α, γ and ε, [k, 3], of triples of steps, [k, 3], where they can be solved for."""
    columns = np.stack((sample.reward - sample.old, sample.best, mean - sample.best), axis=-1)
    matrix, change = columns[triples], sample.change[triples]
    size = np.abs(matrix).max(1, keepdims=True)
    matrix /= size
    good = np.flatnonzero(np.isfinite(matrix).all((1, 2)) & np.isfinite(change).all(1))
    good = good[np.abs(np.linalg.det(matrix[good])) > _SINGULAR]
    answer = np.linalg.solve(matrix[good], change[good][..., None])[..., 0] / size[good, 0]
    return np.column_stack((answer[:, 0], answer[:, 1] / answer[:, 0], answer[:, 2] / answer[:, 1]))


def _with(
    sample: Sample,
    mean: FloatArray,
    found: tuple[float, float, float],
    numbers: Mapping[str, float],
) -> Trial:
    """Return the trial with the ``found`` α, γ and ε, or plainer ones that explain as much."""

    def trial(alpha: float, gamma: float, epsilon: float) -> Trial:
        value = np.where(sample.ended, 0.0, sample.best + epsilon * (mean - sample.best))
        return Trial(sample, UpdateTarget.EXPECTED, sample.reward, value, alpha, gamma, epsilon=epsilon)

    precision = sample.evidence.precision
    as_found = trial(*found)
    plain = trial(*(plainest(each, numbers, max(precision, 1e-8)) for each in found))
    return plain if plain.unexplained <= as_found.unexplained else as_found


def _with_own_epsilons(
    sample: Sample, mean: FloatArray, alpha: float, gamma: float, numbers: Mapping[str, float]
) -> Trial:
    """Return the trial whose ε is another one in each episode, as the first telling step there has it."""
    precision = max(sample.evidence.precision, 1e-8)
    alpha, gamma = plainest(alpha, numbers, precision), plainest(gamma, numbers, precision)
    rest = sample.change / alpha - sample.reward + sample.old - gamma * sample.best
    epsilon = rest / (gamma * (mean - sample.best))
    weight = np.abs(alpha * gamma * (mean - sample.best)) / sample.slack
    weight[~((epsilon > -1e-6) & (epsilon < 1 + 1e-6)) | sample.ended] = 0.0
    episode = sample.evidence.episode[sample.at]
    order = np.lexsort((-weight, episode))  # of each episode the step that tells ε best comes first
    begins = np.flatnonzero(np.diff(episode[order], prepend=-1))
    of_episode = np.repeat(epsilon[order[begins]], np.diff(np.append(begins, len(order))))
    own = np.empty(len(sample))
    own[order] = of_episode
    value = np.where(sample.ended, 0.0, sample.best + own * (mean - sample.best))
    trial = Trial(sample, UpdateTarget.EXPECTED, sample.reward, value, alpha, gamma)
    varied = len(np.unique(np.round(own[np.isfinite(own)], 6))) > 1
    return trial if varied else replace(trial, epsilon=float(own[0]))
