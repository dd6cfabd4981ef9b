"""Step sizes that change: by 1/N with the visits of a cell, or from episode to episode."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Final

import numpy as np

from rl_tui.lab.detective.evidence import order_by
from rl_tui.lab.detective.updates.pair_solving import most_frequent, plainest
from rl_tui.lab.detective.updates.sample import EXACT, Sample
from rl_tui.lab.detective.updates.trial import FEWEST, FEWEST_INFORMATIVE, SHARE, Trial
from rl_tui.lab.detective.verdict import UpdateTarget
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray

_FEWEST_PAIRS: Final = 20


def by_episode(sample: Sample, target: UpdateTarget, numbers: Mapping[str, float]) -> Trial | None:
    """Return the trial whose step size is constant within an episode, or None where it is not so.

    γ comes from neighbours in an episode, which share their step size.
    """
    value = np.where(sample.ended, 0.0, sample.value(target))
    unit = sample.reward - sample.old
    moved = np.flatnonzero(np.abs(sample.change) > 30 * sample.slack)
    episode = sample.evidence.episode[sample.at][moved]
    same = np.flatnonzero(episode[1:] == episode[:-1])
    one, other = moved[same], moved[same + 1]
    if len(one) < _FEWEST_PAIRS:
        return None
    above = sample.change[other] * unit[one] - sample.change[one] * unit[other]
    below = sample.change[one] * value[other] - sample.change[other] * value[one]
    size = np.abs(sample.change[one] * value[other]) + np.abs(sample.change[other] * value[one])
    gamma = np.where(np.abs(below) > 1e-6 * size, above / below, np.nan)
    for each in _discounts(gamma, sample, numbers):
        alpha, reliable = _step_sizes(sample, unit, value, each)
        telling = reliable[one] & reliable[other]
        equal = np.abs(alpha[one] - alpha[other]) <= _near(sample) * np.abs(alpha[one])
        sizes = alpha[moved][reliable[moved]]
        varied = len(sizes) > 0 and np.ptp(sizes) > 1e-4 * np.max(sizes)
        shown = telling & equal & ((value[one] != 0.0) | (value[other] != 0.0))
        if np.any(value) and np.sum(shown) < FEWEST_INFORMATIVE:
            continue  # each step alone explains itself, with any γ
        if np.sum(telling) >= _FEWEST_PAIRS and np.mean(equal[telling]) > SHARE and varied:
            weight = np.where(reliable & ~sample.ended, np.abs(sample.change) / sample.slack, 0.0)
            ruling = _clearest_of_each(sample.evidence.episode[sample.at], alpha, weight)
            return Trial(sample, target, sample.reward, value, ruling, each, schedule="by-episode")
    return None


def by_visits(sample: Sample, target: UpdateTarget, numbers: Mapping[str, float]) -> Trial | None:
    """Return the trial whose step size is 1/N of the visits of the cell, or None where it is not so.

    From one visit to the next 1/α grows by 1: so it does not matter how many visits came before the table was
    found. Episodes in which nothing moved may be counted as visits or not: that is tried both ways.
    """
    value = np.where(sample.ended, 0.0, sample.value(target))
    unit = sample.reward - sample.old
    moved = np.flatnonzero(np.abs(sample.change) > 30 * sample.slack)
    moved = moved[order_by(sample.cell[moved])]
    same = np.flatnonzero(sample.cell[moved][1:] == sample.cell[moved][:-1])
    one, other = moved[same], moved[same + 1]
    if len(one) < FEWEST:
        return None
    for counted in sample.evidence.visits:
        visits = counted[sample.at]
        grown = visits[other] - visits[one]
        above = grown - unit[other] / sample.change[other] + unit[one] / sample.change[one]
        below = value[other] / sample.change[other] - value[one] / sample.change[one]
        gamma = np.where(np.abs(below) > 1e-6, above / below, np.nan)
        for each in _discounts(gamma, sample, numbers):
            alpha, reliable = _step_sizes(sample, unit, value, each)
            telling = reliable[one] & reliable[other] & (grown > 0)
            first, second = 1 / alpha[one], 1 / alpha[other]
            near = 10 * _near(sample) * np.abs(second)
            equal = (np.abs(second - first - grown) <= near) & (np.abs(first - np.rint(first)) <= near)
            if np.sum(telling) >= FEWEST and np.mean(equal[telling]) > SHARE:
                ruling = np.where(reliable, 1 / np.rint(1 / alpha), np.nan)
                return Trial(sample, target, sample.reward, value, ruling, each, schedule="1/N")
    return None


def _discounts(gamma: FloatArray, sample: Sample, numbers: Mapping[str, float]) -> Iterable[float]:
    """Yield likely discount factors: those that pairs of steps agree on, else those of the code, 1 and 0."""
    digits = 6 if sample.evidence.precision < EXACT else 3
    gamma = np.where(np.abs(gamma) < 1e-9, 0.0, gamma)
    precision = max(sample.evidence.precision, 1e-8)
    found = [plainest(each, numbers, precision) for (each,) in most_frequent(gamma[:, None], digits, 3)]
    named = [each for each in numbers.values() if 0.0 < each <= 1.0][:20]
    yield from dict.fromkeys((*found, *named, 1.0, 0.0))


def _step_sizes(
    sample: Sample, unit: FloatArray, value: FloatArray, gamma: float
) -> tuple[FloatArray, BoolArray]:
    """Return the step size of each step, [n], and where that is exact enough."""
    error = unit + gamma * value
    alpha = sample.change / error
    reliable = (np.abs(sample.change) > 100 * sample.slack) & np.isfinite(alpha)
    cancels = np.abs(error) < 1e-6 * (np.abs(unit) + np.abs(gamma * value))
    result: BoolArray = reliable & ~cancels
    return alpha, result


def _near(sample: Sample) -> float:
    return 1e-6 if sample.evidence.precision < EXACT else 3e-2


def _clearest_of_each(group: IntArray, numbers: FloatArray, weight: FloatArray) -> FloatArray:
    """Return for each place the number with the largest ``weight`` in its group, [n]; NaN if all weigh 0."""
    order = np.lexsort((-weight, group))
    begins = np.flatnonzero(np.diff(group[order], prepend=-1))
    clearest = np.where(weight > 0.0, numbers, np.nan)[order[begins]]
    result: FloatArray = np.empty(len(group))
    result[order] = np.repeat(clearest, np.diff(np.append(begins, len(order))))
    return result
