"""A hypothesis about an update with its numbers, and which steps it explains."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np

from rl_tui.lab.detective.updates.pair_solving import plainest, refined, rounded, solved_pairs
from rl_tui.lab.detective.updates.sample import EXACT, Sample
from rl_tui.lab.detective.verdict import AlphaSchedule, UpdateTarget
from rl_tui.worlds.mdp.space import BoolArray, FloatArray

FEWEST: Final = 10
"""Fewer steps that moved something prove no update."""
FEWEST_INFORMATIVE: Final = 3
"""Fewer steps prove neither γ nor that one of two hypotheses is the right one."""
FEWEST_EQUATIONS: Final = 3
"""So many different equations must agree on an update: two numbers are solved from two of them."""
_DIGITS: Final = 6
_AT_A_TIME: Final = 200
SHARE: Final = 0.97
"""What an update must explain more than."""
_OWN_SHARE: Final = 0.99
"""The same with a reward of the program's own, which is fitted to the steps itself."""
_WEIGHTY: Final = 100.0
"""A value matters on a step if it moves the cell by so many times what a prediction may be off."""


@dataclass(frozen=True)
class Trial:
    """An update: change = α·(reward − old + γ·value); [n] are the steps of ``sample``.

    ``alpha`` is one number, or one for each step, with NaN where nothing tells it. ``value`` is 0 where the
    episode ended. ``epsilon`` is that of Expected SARSA, where it is constant.
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
        """By how much the cell is to move, [n]; NaN where that cannot be said."""
        return self.alpha * (self.reward - self.sample.old + self.gamma * self.value)

    @cached_property
    def explained(self) -> BoolArray:
        """The steps that it explains, [n]; at an end with the value of the next state or without."""
        sample = self.sample
        off = np.abs(sample.change - self.predicted)
        after_end = self.predicted + self.alpha * self.gamma * sample.best
        off = np.where(sample.ended, np.fmin(off, np.abs(sample.change - after_end)), off)
        result: BoolArray = off <= sample.slack
        return result

    @cached_property
    def counted(self) -> BoolArray:
        """The steps on which something moved or was to move, [n]: all others speak for nothing."""
        result: BoolArray = (self.sample.change != 0.0) | (np.abs(self.predicted) > self.sample.slack)
        return result & ~np.isnan(self.predicted)

    @cached_property
    def informative(self) -> BoolArray:
        """The steps on which the value of the next state matters, [n]."""
        size = np.abs(self.alpha * self.value)
        result: BoolArray = (size > _WEIGHTY * self.sample.slack) & ~self.sample.ended & self.counted
        return result

    @property
    def unexplained(self) -> int:
        """How many of the steps that count it does not explain."""
        return int(np.sum(self.counted & ~self.explained))

    @property
    def share(self) -> float:
        """The share of the steps that count that it explains."""
        return 1.0 - self.unexplained / max(1, int(np.sum(self.counted)))

    @cached_property
    def holds(self) -> bool:
        """Whether it explains enough: the steps within episodes, or all where there are few of these."""
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
        """Whether enough steps tell γ, and not all of them the same."""
        return self._equations(self.informative & self.explained) >= FEWEST_EQUATIONS

    def _equations(self, which: BoolArray) -> int:
        """Return how many of the steps ``which`` say something new: at a first visit many are the same.

        More than need be are not counted.
        """
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
        """Return on which steps within episodes ``value`` in place of its own predicts other numbers."""
        size = np.abs(self.alpha * self.gamma * (self.value - value))
        result: BoolArray = (size > 3 * self.sample.slack) & ~self.sample.ended & self.counted
        return result


def constant_trial(
    sample: Sample,
    target: UpdateTarget,
    reward: FloatArray,
    numbers: Mapping[str, float],
    uses_reward_before: bool = False,
) -> Trial | None:
    """Return the best trial with a constant step size for ``target`` and ``reward`` [n]; None without any."""
    value = np.where(sample.ended, 0.0, sample.value(target))
    known = ~np.isnan(value) & (np.abs(sample.change) > 30 * sample.slack)
    if not known.any():
        known = ~np.isnan(value)
    digits = 7 if sample.evidence.precision < EXACT else 3
    found = solved_pairs((reward - sample.old)[known], value[known], sample.change[known], digits)
    trials = []
    for a, b in found:
        gamma = 0.0 if np.isnan(b) else b / a
        first = Trial(sample, target, reward, value, a, gamma, uses_reward_before=uses_reward_before)
        trials.append(polished(first, numbers))
    return min(trials, key=lambda trial: trial.unexplained, default=None)


def polished(trial: Trial, numbers: Mapping[str, float]) -> Trial:
    """Return ``trial`` with a constant step size and γ as exact as its steps tell them."""
    sample, precision = trial.sample, trial.sample.evidence.precision
    if precision > EXACT:  # the pairs gave three digits
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
        alpha=plainest(better.alpha, numbers, precision),
        gamma=plainest(better.gamma, numbers, precision) if abs(better.gamma) > 1e-9 else 0.0,
    )
    return plain if plain.unexplained <= better.unexplained else better
