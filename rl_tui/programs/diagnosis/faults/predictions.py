"""Predictions of each step by the update found."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from typing import Final, NamedTuple

import numpy as np

from rl_tui.programs.diagnosis.faults.cells import some_of
from rl_tui.programs.diagnosis.sample import ReadEstimates
from rl_tui.programs.evidence.evidence import Evidence
from rl_tui.programs.evidence.verdict import MovedCell, Rule, UpdateFound, UpdateTarget
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray

# Predictions of a step


_PRECISION: Final = {"float32": 3e-6, "float16": 4e-3}
_EXACT: Final = 1e-9
_CLEARLY: Final = 100.0
"""Two predictions are distinct if they differ by this multiple of the precision."""
_MOST_SOLVED: Final = 100_000
_FEW: Final = 10_000
_FEWEST: Final = 10
_EXCEPTIONS: Final = 0.03


class Readings(NamedTuple):
    """The moved cells before and after n steps, `[n]` each."""

    at: IntArray
    before: FloatArray
    after: FloatArray


class Witnesses(NamedTuple):
    """Steps that support each of two hypotheses, `[n]`."""

    one: BoolArray
    other: BoolArray
    neither: BoolArray
    """Steps that neither hypothesis predicts."""


class Predictions:
    """Predicts every step under the rule `update`."""

    def __init__(self, evidence: Evidence, update: UpdateFound) -> None:
        self.evidence, self.update = evidence, update
        self._precision = _PRECISION.get(evidence.dtype, _EXACT)

    @property
    def is_known(self) -> bool:
        """True if steps are predicted, perhaps only with a next value of 0."""
        update = self.update
        has_step_size = update.alpha is not None or update.alpha_schedule is not None
        return has_step_size and update.rule is not Rule.MONTE_CARLO

    @cached_property
    def moved_cell(self) -> IntArray:
        """The cell of each step, `[N]`."""
        evidence = self.evidence
        if self.update.place is MovedCell.MOVED:
            return evidence.next_state * evidence.actions + evidence.action
        return evidence.cell

    @cached_property
    def is_plain(self) -> BoolArray:
        """Steps that moved only their own cell or nothing, `[N]`, before numbers diverge."""
        evidence = self.evidence
        own: BoolArray = evidence.stays | (evidence.only_change[0] == self.moved_cell)
        return own & (evidence.number < evidence.runs_away_at)

    @cached_property
    def alpha(self) -> FloatArray:
        """Step size of each step, `[N]`, NaN if unknown."""
        if self.update.alpha is not None:
            return np.full(len(self.evidence), self.update.alpha)
        if self.update.alpha_schedule == "1/N":
            return self._alpha_by_visits()
        if self.update.alpha_schedule == "by-episode":
            return self._alpha_by_episode()
        return np.full(len(self.evidence), np.nan)

    @cached_property
    def gamma(self) -> float:
        """The discount, NaN if unknown."""
        return np.nan if self.update.gamma is None else self.update.gamma

    def readings(self, at: IntArray) -> Readings:
        """Return the effect of plain steps on their cells."""
        at = at[self.is_plain[at]]
        evidence = self.evidence
        before = evidence.history.before(self.moved_cell[at], evidence.number[at])
        return Readings(
            at, before, np.where(evidence.changes_of[at] > 0, evidence.only_change[2][at], before)
        )

    def values(self, at: IntArray, target: UpdateTarget | None = None) -> FloatArray:
        """Return the possible next values, `[n, K]`."""
        evidence, update = self.evidence, self.update
        states, actions = evidence.state[at], evidence.action[at]
        reads = ReadEstimates(
            evidence, at, states, actions, evidence.next_state[at], evidence.next_action[at]
        )
        return reads.values(target or update.target, update.epsilon)

    def after(self, readings: Readings, reward: FloatArray, values: FloatArray) -> FloatArray:
        """Return new values, `[n, K]`, for `reward`, `[n]`, and next `values`, `[n, K]`."""
        before, alpha = readings.before[:, None], self.alpha[readings.at][:, None]
        discounted = np.where(values == 0.0, 0.0, self.gamma * values)  # 0 whatever γ is
        predicted: FloatArray = before + alpha * (reward[:, None] + discounted - before)
        return predicted

    def witnesses(self, readings: Readings, one: FloatArray, other: FloatArray) -> Witnesses:
        """Return which steps support `one`, `[n, K]`, and `other`, `[n, L]`, where these clearly differ."""
        scale = np.maximum(np.abs(readings.before), np.abs(readings.after))
        scale = np.maximum(scale, np.maximum(np.abs(one).max(1), np.abs(other).max(1)))
        near = self._precision * scale + np.finfo(np.float64).tiny
        clear = np.ones(len(scale), np.bool_)
        for column in other.T:
            clear &= (np.abs(one - column[:, None]) > _CLEARLY * near[:, None]).all(1)
        after = readings.after[:, None]
        fits_one = (np.abs(one - after) <= near[:, None]).any(1)
        fits_other = (np.abs(other - after) <= near[:, None]).any(1)
        moved = readings.before != readings.after
        return Witnesses(clear & fits_one, clear & fits_other, clear & moved & ~fits_one & ~fits_other)

    def _alpha_by_visits(self) -> FloatArray:
        """Return 1/N, where N may have an offset, or NaN if most steps disagree."""
        at, solved = self._solved_alpha()
        for visits in self.evidence.visits:
            more = np.rint(1.0 / solved - visits[at])
            usual = float(np.median(more)) if len(more) else 0.0
            if len(more) and np.mean(more == usual) > 1.0 - _EXCEPTIONS:
                size: FloatArray = 1.0 / np.maximum(visits + usual, 1.0)
                return size
        return np.full(len(self.evidence), np.nan)

    def _alpha_by_episode(self) -> FloatArray:
        evidence = self.evidence
        at, solved = self._solved_alpha()
        if not len(solved):
            return np.full(len(evidence), np.nan)
        episode = evidence.episode[at]
        order = np.lexsort((solved, episode))
        names, first, count = np.unique(episode[order], return_index=True, return_counts=True)
        middle = solved[order][first + (count - 1) // 2]
        place = np.minimum(np.searchsorted(names, evidence.episode), len(names) - 1)
        return np.where(names[place] == evidence.episode, middle[place], np.nan)

    def _solved_alpha(self) -> tuple[IntArray, FloatArray]:
        evidence = self.evidence
        readings = self.readings(_thinned(np.flatnonzero(evidence.inner)))
        values = self.values(readings.at)[:, 0]
        error = evidence.reward[readings.at] + self.gamma * values - readings.before
        with np.errstate(divide="ignore", invalid="ignore"):
            solved = (readings.after - readings.before) / error
        known = np.isfinite(solved) & (solved != 0.0)
        return readings.at[known], solved[known]


def by_the_environment(evidence: Evidence, update: UpdateFound) -> Predictions:
    """Predict with the environment's reward, unless inner steps need another one."""
    predictions = Predictions(evidence, update)
    if update.reward != "own" or update.place is MovedCell.ONE_LATE:
        return predictions
    plainer = Predictions(evidence, replace(update, reward="environment"))
    readings = plainer.readings(some_of(np.flatnonzero(evidence.inner), _FEW))
    expected = plainer.after(readings, evidence.reward[readings.at], plainer.values(readings.at))
    seen = plainer.witnesses(readings, expected, readings.before[:, None])
    explained, others = int(seen.one.sum()), int(seen.neither.sum())
    return plainer if explained >= _FEWEST and others <= _EXCEPTIONS * explained else predictions


def _thinned(at: IntArray) -> IntArray:
    return at[:: max(1, -(-len(at) // _MOST_SOLVED))]
