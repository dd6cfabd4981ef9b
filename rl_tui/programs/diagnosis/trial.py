"""Hypotheses about an update, each with the steps it explains.

The numbers of an update are solved from a few steps at a time. The true ones occur most often.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np

from rl_tui.programs.diagnosis.sample import EXACT, Sample
from rl_tui.programs.evidence.evidence import Evidence, order_by
from rl_tui.programs.evidence.verdict import AlphaSchedule, UpdateTarget
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray

# Solving for two numbers


_PAIRS: Final = 3_000
_VOTES: Final = 4_000
_SINGULAR: Final = 1e-6
_NOTHING: Final = 1e-9
_SEED: Final = 17
_PRIMES: Final = (2, 3, 5)
"""Their roots combine a row to one number, since sorting rows is ten times slower."""


def rounded(numbers: FloatArray, digits: int) -> FloatArray:
    """Round to `digits` significant digits."""
    scale = 10.0 ** (digits - 1 - np.floor(np.log10(np.abs(numbers))))
    result: FloatArray = np.where(numbers == 0.0, 0.0, np.rint(numbers * scale) / scale)
    return result


def most_frequent(rows: FloatArray, digits: int, most: int) -> list[tuple[float, ...]]:
    """Return the most frequent of `rows`, `[n, k ≤ 3]`, or of some, as medians of equal rounded ones."""
    rows = rows[np.isfinite(rows).all(1)]
    if not len(rows):
        return []
    rows = rows[:: -(-len(rows) // _VOTES)]
    same = rounded(rows, digits)
    key = sum(column * np.sqrt(prime) for column, prime in zip(same.T, _PRIMES, strict=False))
    _, group, counts = np.unique(key, return_inverse=True, return_counts=True)
    first = np.argsort(-counts, kind="stable")[:most]
    return [tuple(map(float, np.median(rows[group == each], axis=0))) for each in first if counts[each] > 1]


def solved_pairs(
    unit: FloatArray, value: FloatArray, change: FloatArray, digits: int, most: int = 4
) -> list[tuple[float, float]]:
    """Return likely (a, b) with a · unit + b · value = change, all `[n]`, the most likely first.

    Without any value, b is NaN.
    """
    moved = np.flatnonzero(change != 0.0)
    if not len(moved):
        return []
    weighty = moved[value[moved] != 0.0]
    if not len(weighty):
        moved = moved[unit[moved] != 0.0]
        alone = (change[moved] / unit[moved])[:, None]
        return [(a, float("nan")) for (a,) in most_frequent(alone, digits, most)]
    one, other = drawn(weighty, 0), drawn(moved, 1)
    up, uq, vp, vq = unit[one], unit[other], value[one], value[other]
    cp, cq = change[one], change[other]
    determinant = up * vq - uq * vp
    good = np.abs(determinant) > _SINGULAR * (np.abs(up * vq) + np.abs(uq * vp))
    a, b = (cp * vq - cq * vp) / determinant, (up * cq - uq * cp) / determinant
    ratio = b / a
    pairs = np.column_stack((a, np.where(np.abs(ratio) < _NOTHING, 0.0, ratio)))[good]
    return [(a, a * ratio) for a, ratio in most_frequent(pairs, digits, most)]


def drawn(places: IntArray, stream: int, count: int = _PAIRS) -> IntArray:
    """Draw `count` of `places` with replacement, the same for each `stream`."""
    return places[np.random.default_rng((_SEED, stream)).integers(0, len(places), count)]


def refined(
    columns: Iterable[FloatArray], change: FloatArray, slack: FloatArray, within: BoolArray
) -> list[float] | None:
    """Return the factors of `columns`, `[n]` each, that come closest to `change`, or None.

    `slack`, `[n]`, is the tolerance, and `within`, `[n]`, selects steps.
    """
    weight = 1.0 / slack[within]
    matrix = np.column_stack([column[within] * weight for column in columns])
    wanted = change[within] * weight
    finite = np.isfinite(matrix).all(1) & np.isfinite(wanted)  # LAPACK prints messages about other numbers
    matrix, wanted = matrix[finite], wanted[finite]
    size = np.abs(matrix).max(0, initial=0.0)
    if len(matrix) < matrix.shape[1] or np.any(size == 0.0):
        return None
    answer, _, rank, _ = np.linalg.lstsq(matrix / size, wanted, rcond=1e-9)
    return [float(each) for each in answer / size] if rank == matrix.shape[1] else None


def plainest(number: float, evidence: Evidence, precision: float = 0.0) -> float:
    """Return the simplest number within `precision`, or that of the table, perhaps one in the code."""
    precision = max(precision, evidence.precision)
    near = 1e-8 if precision < 1e-8 else 20 * precision
    near *= max(abs(number), 1e-300)
    for digits in (1, 2, 3, 4, 5, 6):
        short = float(f"{number:.{digits}g}")
        if abs(short - number) <= near:
            return short
    for each in evidence.numbers.values():
        if abs(each - number) <= near:
            return float(each)
    return number


# A trial


FEWEST: Final = 10
"""Fewest moving steps that prove an update."""
FEWEST_INFORMATIVE: Final = 3
"""Fewest steps that prove γ, or decide between two hypotheses."""
FEWEST_EQUATIONS: Final = 3
"""Fewest distinct equations that must agree, since two of them determine two numbers."""
_DIGITS: Final = 6
ROUGH: Final = 1e-8
"""Least precision of numbers solved from single steps."""
_AT_A_TIME: Final = 200
SHARE: Final = 0.97
"""Share that an update must exceed."""
_OWN_SHARE: Final = 0.99
"""The same for a reward of the program's own, which is fitted to the steps."""
_WEIGHTY: Final = 100.0
"""A value matters if it moves the cell by this multiple of the tolerance."""


@dataclass(frozen=True)
class Trial:
    """The hypothesis change = α · (reward − old + γ · value) on the n steps of `sample`.

    `alpha` is one number or one for each step, NaN if undetermined. `value` is 0 at an end. `epsilon` belongs
    to Expected SARSA.
    """

    sample: Sample
    target: UpdateTarget
    reward: FloatArray
    value: FloatArray
    alpha: float | FloatArray
    gamma: float
    schedule: AlphaSchedule = "constant"
    uses_reward_before: bool = False
    own_reward: bool = False
    epsilon: float | None = None

    @cached_property
    def predicted(self) -> FloatArray:
        """Predicted change, `[n]`, NaN if undetermined."""
        return self.alpha * (self.reward - self.sample.old + self.gamma * self.value)

    @cached_property
    def explained(self) -> BoolArray:
        """Explained steps, `[n]`. At an end, the next value is optional."""
        sample = self.sample
        off = np.abs(sample.change - self.predicted)
        after_end = self.predicted + self.alpha * self.gamma * sample.best
        off = np.where(sample.ended, np.fmin(off, np.abs(sample.change - after_end)), off)
        result: BoolArray = off <= sample.slack
        return result

    @cached_property
    def counted(self) -> BoolArray:
        """Steps with an actual or predicted change, `[n]`."""
        result: BoolArray = (self.sample.change != 0.0) | (np.abs(self.predicted) > self.sample.slack)
        return result & ~np.isnan(self.predicted)

    @cached_property
    def informative(self) -> BoolArray:
        """Steps with a relevant next value, `[n]`."""
        size = np.abs(self.alpha * self.value)
        result: BoolArray = (size > _WEIGHTY * self.sample.slack) & ~self.sample.ended & self.counted
        return result

    @property
    def unexplained(self) -> int:
        """Number of counted steps without explanation."""
        return int(np.sum(self.counted & ~self.explained))

    @property
    def share(self) -> float:
        """Share of explained counted steps."""
        return 1.0 - self.unexplained / max(1, int(np.sum(self.counted)))

    @cached_property
    def holds(self) -> bool:
        """True if it explains enough inner steps, or all of a few."""
        if self.gamma < 0.0 or self._equations(self.counted & self.explained) < FEWEST_EQUATIONS:
            return False
        inner = self.counted & ~self.sample.ended
        if np.sum(inner) < FEWEST:
            inner = self.counted
        share = _OWN_SHARE if self.own_reward else SHARE
        if np.sum(inner) < FEWEST or np.mean(self.explained[inner]) <= share:
            return False
        telling = self.informative
        return not telling.any() or bool(np.mean(self.explained[telling]) > share)

    @property
    def tells_gamma(self) -> bool:
        """True if distinct steps determine γ."""
        return self._equations(self.informative & self.explained) >= FEWEST_EQUATIONS

    def _equations(self, which: BoolArray) -> int:
        """Count distinct equations up to the required number. First visits often repeat one."""
        places = np.flatnonzero(which)
        unit = self.reward - self.sample.old
        rows: set[tuple[float, ...]] = set()
        for begin in range(0, len(places), _AT_A_TIME):
            at = places[begin : begin + _AT_A_TIME]
            table = np.column_stack((unit[at], self.value[at], self.sample.change[at]))
            rows.update(map(tuple, rounded(table, _DIGITS).tolist()))
            if len(rows) >= FEWEST_EQUATIONS:
                break
        return len(rows)

    def differs_from(self, value: FloatArray) -> BoolArray:
        """Return the inner steps on which `value` predicts other numbers."""
        size = np.abs(self.alpha * self.gamma * (self.value - value))
        result: BoolArray = (size > 3 * self.sample.slack) & ~self.sample.ended & self.counted
        return result


def constant_trial(
    sample: Sample, target: UpdateTarget, reward: FloatArray, uses_reward_before: bool = False
) -> Trial | None:
    """Return the best trial with a constant step size for `reward`, `[n]`, if any."""
    value = sample.next_value(target)
    known = ~np.isnan(value) & (np.abs(sample.change) > 30 * sample.slack)
    if not known.any():
        known = ~np.isnan(value)
    digits = 7 if sample.evidence.precision < EXACT else 3
    found = solved_pairs((reward - sample.old)[known], value[known], sample.change[known], digits)
    trials = []
    for a, b in found:
        gamma = 0.0 if np.isnan(b) else b / a
        first = Trial(sample, target, reward, value, a, gamma, uses_reward_before=uses_reward_before)
        trials.append(_polished(first))
    return min(trials, key=lambda trial: trial.unexplained, default=None)


def _polished(trial: Trial) -> Trial:
    sample, evidence = trial.sample, trial.sample.evidence
    if evidence.precision > EXACT:  # the pairs gave three digits
        near = np.abs(sample.change - trial.predicted) <= np.maximum(
            10 * sample.slack, 5e-3 * np.abs(sample.change)
        )
    else:
        near = trial.explained
    near &= (sample.change != 0.0) & ~np.isnan(trial.value)
    unit = trial.reward - sample.old
    answer = refined((unit, trial.value), sample.change, sample.slack, near)
    if answer is None:
        alone = refined((unit,), sample.change, sample.slack, near)
        answer = [alone[0], alone[0] * trial.gamma] if alone else None
    better = trial
    if answer and answer[0]:
        better = replace(trial, alpha=answer[0], gamma=answer[1] / answer[0])
        if better.unexplained > trial.unexplained:
            better = trial
    assert isinstance(better.alpha, float)
    plain = replace(
        better,
        alpha=plainest(better.alpha, evidence),
        gamma=plainest(better.gamma, evidence) if abs(better.gamma) > 1e-9 else 0.0,
    )
    return plain if plain.unexplained <= better.unexplained else better


# Step sizes that change


_FEWEST_PAIRS: Final = 20


def by_episode(sample: Sample, target: UpdateTarget) -> Trial | None:
    """Return the trial with a constant step size in each episode, if any. Neighbours share it, and give γ."""
    value, unit = sample.next_value(target), sample.unit
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
    for each in _discounts(gamma, sample):
        alpha, reliable = _step_sizes(sample, unit, value, each)
        telling = reliable[one] & reliable[other]
        equal = np.abs(alpha[one] - alpha[other]) <= _near(sample) * np.abs(alpha[one])
        sizes = alpha[moved][reliable[moved]]
        varied = len(sizes) > 0 and np.ptp(sizes) > 1e-4 * np.max(sizes)
        shown = telling & equal & ((value[one] != 0.0) | (value[other] != 0.0))
        if np.any(value) and np.sum(shown) < FEWEST_INFORMATIVE:
            continue  # each step explains itself, with any γ
        if np.sum(telling) >= _FEWEST_PAIRS and np.mean(equal[telling]) > SHARE and varied:
            weight = np.where(reliable & ~sample.ended, np.abs(sample.change) / sample.slack, 0.0)
            known = np.where(weight > 0.0, alpha, np.nan)
            ruling = clearest_of_each(sample.evidence.episode[sample.at], known, weight)
            return Trial(sample, target, sample.reward, value, ruling, each, schedule="by-episode")
    return None


def by_visits(sample: Sample, target: UpdateTarget) -> Trial | None:
    """Return the trial with step size 1/N of the visits to a cell, if any.

    1/α grows by 1 between visits, so earlier visits do not matter. Episodes without changes may not count.
    """
    value, unit = sample.next_value(target), sample.unit
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
        for each in _discounts(gamma, sample):
            alpha, reliable = _step_sizes(sample, unit, value, each)
            telling = reliable[one] & reliable[other] & (grown > 0)
            first, second = 1 / alpha[one], 1 / alpha[other]
            near = 10 * _near(sample) * np.abs(second)
            equal = (np.abs(second - first - grown) <= near) & (np.abs(first - np.rint(first)) <= near)
            if np.sum(telling) >= FEWEST and np.mean(equal[telling]) > SHARE:
                ruling = np.where(reliable, 1 / np.rint(1 / alpha), np.nan)
                return Trial(sample, target, sample.reward, value, ruling, each, schedule="1/N")
    return None


def _discounts(gamma: FloatArray, sample: Sample) -> Iterable[float]:
    gamma = np.where(np.abs(gamma) < 1e-9, 0.0, gamma)
    solved = most_frequent(gamma[:, None], sample.digits, 3)
    found = [plainest(each, sample.evidence, ROUGH) for (each,) in solved]
    named = [each for each in sample.evidence.numbers.values() if 0.0 < each <= 1.0][:20]
    yield from dict.fromkeys((*found, *named, 1.0, 0.0))


def _step_sizes(
    sample: Sample, unit: FloatArray, value: FloatArray, gamma: float
) -> tuple[FloatArray, BoolArray]:
    error = unit + gamma * value
    alpha = sample.change / error
    reliable = (np.abs(sample.change) > 100 * sample.slack) & np.isfinite(alpha)
    cancels = np.abs(error) < 1e-6 * (np.abs(unit) + np.abs(gamma * value))
    result: BoolArray = reliable & ~cancels
    return alpha, result


def _near(sample: Sample) -> float:
    return 1e-6 if sample.evidence.precision < EXACT else 3e-2


def clearest_of_each(group: IntArray, numbers: FloatArray, weight: FloatArray) -> FloatArray:
    """Return the number of the largest weight in each step's group, `[n]`."""
    order = np.lexsort((-weight, group))
    begins = np.flatnonzero(np.diff(group[order], prepend=-1))
    result: FloatArray = np.empty(len(group))
    result[order] = np.repeat(numbers[order[begins]], np.diff(np.append(begins, len(order))))
    return result
