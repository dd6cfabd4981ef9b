"""Averages of many runs, with an interval for the mean."""

from __future__ import annotations

import math
import statistics
from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from typing import Final

import numpy as np
import numpy.typing as npt

from rl_tui.worlds.mdp.space import FloatArray

CONFIDENCE: Final = 0.95
SHARE_BELOW: Final = 0.5 + CONFIDENCE / 2
"""Share below the upper end of an interval."""
FEWEST_RUNS: Final = 10
"""Fewest runs for statements about the mean."""
RESAMPLES: Final = 20_000
MOST_RESAMPLED: Final = 300
"""Runs above which a formula replaces resampling, which would differ as much by chance."""
EQUAL: Final = 1e-9
"""Relative difference below which results are equal, since exact results are no more accurate."""
SEED: Final = 20_210_830
_TIE: Final = 1e-12  # tolerance of resampled means, in units of the largest deviation


@dataclass(frozen=True, slots=True)
class Summary:
    """Averages of some runs, with the ends of the 95 % interval of the mean (None below `FEWEST_RUNS`)."""

    mean: float
    median: float
    iqm: float
    low: float | None
    high: float | None
    count: int


def summary_of(values: Iterable[float], seed: int = SEED) -> Summary | None:
    """Return the averages of `values`, or None. Equal values give equal bits in any order.

    Raises ValueError if a value is not finite.
    """
    ordered = np.sort(_finite(values))
    if not ordered.size:
        return None
    low, high = interval_of(ordered, seed) or (None, None)
    return Summary(
        statistics.fmean(ordered),
        float(np.median(ordered)),
        interquartile_mean(ordered),
        low,
        high,
        ordered.size,
    )


def interquartile_mean(values: Iterable[float]) -> float:
    """Return the mean of the middle half of `values`.

    The i-th of n sorted values covers [i/n, (i+1)/n], and its weight is the part of that in [1/4, 3/4]
    (Agarwal et al., "Deep Reinforcement Learning at the Edge of the Statistical Precipice", 2021). Raises
    ValueError if there is no value, or one is not finite.
    """
    ordered = np.sort(_finite(values))
    if not ordered.size:
        raise ValueError("an interquartile mean needs at least one value")
    edges = np.clip(np.arange(ordered.size + 1) / ordered.size, 0.25, 0.75)
    first = ordered[0]  # equal values then give exactly this value
    return float(first + 2.0 * np.sum(np.diff(edges) * (ordered - first)))


def interval_of(values: Iterable[float], seed: int = SEED) -> tuple[float, float] | None:
    """Return the 95 % interval of the mean of `values`, or None below `FEWEST_RUNS`.

    Equal values give width 0. For two different values the mean is a share, with Wilson's interval. `EQUAL`
    neighbours count as one value. Otherwise it is an expanded BCa bootstrap interval, or `_skewness_interval`
    for many values. Raises ValueError if a value is not finite.
    """
    ordered = np.sort(_finite(values))
    count = ordered.size
    if count < FEWEST_RUNS:
        return None
    largest = max(abs(ordered[0]), abs(ordered[-1]))
    steps = np.flatnonzero(np.diff(ordered) > EQUAL * largest)
    if not steps.size:
        return float(ordered[0]), float(ordered[-1])
    if steps.size == 1:
        last = int(steps[0])
        least, most = float(ordered[last]), float(ordered[last + 1])
        low, high = share_interval(count - 1 - last, count)
        return least + low * (most - least), least + high * (most - least)
    mean = statistics.fmean(ordered)
    deviations = ordered - mean
    scale = float(np.max(np.abs(deviations)))
    ends = _skewness_interval if count > MOST_RESAMPLED else _bootstrap_interval
    low, high = ends(deviations / scale, seed)
    return mean + scale * low, mean + scale * high


def share_interval(successes: int, count: int) -> tuple[float, float]:
    """Return Wilson's 95 % interval of the share `successes` / `count` (E. B. Wilson, "Probable Inference,
    the Law of Succession, and Statistical Inference", 1927).

    For its coverage see Brown, Cai and DasGupta, "Interval Estimation for a Binomial Proportion", 2001.
    Raises ValueError if `successes` is not in [0, `count`], or `count` is 0.
    """
    if not 0 <= successes <= count or not count:
        raise ValueError(f"{successes} of {count} is not a valid share")
    share, z = successes / count, _normal_quantile(SHARE_BELOW)
    middle = (share + z * z / (2 * count)) / (1 + z * z / count)
    half = z / (1 + z * z / count) * (share * (1 - share) / count + z * z / (4 * count * count)) ** 0.5
    # at either end the formula gives exactly 0 or 1, except for rounding
    low = 0.0 if successes == 0 else max(0.0, middle - half)
    high = 1.0 if successes == count else min(1.0, middle + half)
    return low, high


def _bootstrap_interval(deviations: FloatArray, seed: int) -> tuple[float, float]:
    """Return the expanded BCa interval of the mean, from sorted `deviations`, `[n]` (Efron, "Better Bootstrap
    Confidence Intervals", 1987; Hesterberg, "What Teachers Should Know About the Bootstrap", 2015).
    """
    means = np.sort(deviations.take(resamples(deviations.size, seed)).sum(axis=0) / deviations.size)
    return _ends(means, deviations)


def _ends(means: FloatArray, deviations: FloatArray) -> tuple[float, float]:
    """Return the quantiles of sorted `means` after BCa's correction of bias and acceleration."""
    ties = np.searchsorted(means, (-_TIE, _TIE))
    below = float(np.clip(ties.mean() / means.size, 1 / means.size, 1 - 1 / means.size))
    bias = _normal_quantile(below)
    acceleration = _skewness(deviations) / (6 * deviations.size**0.5)
    reach = (
        student_quantile(SHARE_BELOW, deviations.size - 1) * (deviations.size / (deviations.size - 1)) ** 0.5
    )
    low, high = (
        _quantile(means, _normal_share(bias + (bias + z) / (1 - acceleration * (bias + z))))
        for z in (-reach, reach)
    )
    return low, high


def _skewness_interval(deviations: FloatArray, seed: int) -> tuple[float, float]:
    """Return Student's interval, shifted for skewness (N. J. Johnson, "Modified t Tests and Confidence
    Intervals for Asymmetrical Populations", 1978).
    """
    count = deviations.size
    error = float(np.sum(deviations**2) / (count - 1) / count) ** 0.5
    t = student_quantile(SHARE_BELOW, count - 1)
    shift = _skewness(deviations) / (6 * count**0.5) * (1 + 2 * t * t)
    return error * (shift - t), error * (shift + t)


def _skewness(deviations: FloatArray) -> float:
    return float(np.mean(deviations**3) / np.mean(deviations**2) ** 1.5)


@lru_cache(maxsize=4)  # up to 12 MB each
def resamples(count: int, seed: int) -> npt.NDArray[np.uint16]:
    """Return the drawn ranks of each resample, `[count, RESAMPLES]`, shared by all cells with `count` runs.

    Every value is drawn equally often, so the mean of the resamples is the mean (Davison, Hinkley and
    Schechtman, "Efficient Bootstrap Simulation", 1986). Each resample has a mirror image, so that results and
    their negatives give mirrored intervals.
    """
    generator = np.random.Generator(np.random.PCG64(np.random.SeedSequence([seed, count])))
    ranks = np.repeat(np.arange(count, dtype=np.uint16), RESAMPLES // 2)
    half = generator.permutation(ranks).reshape(count, RESAMPLES // 2)
    drawn = np.hstack([half, np.uint16(count - 1) - half])
    drawn.flags.writeable = False
    return drawn


def _quantile(ordered: FloatArray, share: float) -> float:
    place = share * (ordered.size - 1)
    before = int(place)
    after = min(before + 1, ordered.size - 1)
    return float(ordered[before] + (place - before) * (ordered[after] - ordered[before]))


def student_share(t: float, freedom: int) -> float:
    """Return the probability that Student's t is below `t`, which may be infinite.

    It is exact to about 1e-12 (Abramowitz and Stegun, equations 26.7.3 and 26.7.4).
    """
    angle = math.atan2(t, math.sqrt(freedom))
    sine, cosine = math.sin(angle), math.cos(angle)
    is_odd = freedom % 2
    number = np.arange(1.0 + is_odd, freedom - 2.0, 2.0)
    series = 1.0 + float(np.cumprod(number / (number + 1.0) * cosine**2).sum())
    if not is_odd:
        inside = sine * series
    else:
        inside = (angle + (sine * cosine * series if freedom > 1 else 0.0)) * 2.0 / math.pi
    return min(1.0, max(0.0, 0.5 + inside / 2.0))


@lru_cache(maxsize=256)
def student_quantile(share: float, freedom: int) -> float:
    """Return the quantile of Student's t for `share`, 0.5 or more."""
    low, high = 0.0, math.pi / 2  # √freedom times the tangent is the value
    while low < (middle := (low + high) / 2) < high:
        if student_share(math.sqrt(freedom) * math.tan(middle), freedom) < share:
            low = middle
        else:
            high = middle
    return math.sqrt(freedom) * math.tan(high)


def _normal_quantile(share: float) -> float:
    return statistics.NormalDist().inv_cdf(share)


def _normal_share(quantile: float) -> float:
    return statistics.NormalDist().cdf(quantile)


def _finite(values: Iterable[float]) -> FloatArray:
    array = np.asarray(values if isinstance(values, np.ndarray) else list(values), np.float64)
    if not np.isfinite(array).all():
        raise ValueError("a mean needs finite values")
    return array
