"""A bounded, reproducible choice of steps for testing hypotheses."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Final

import numpy as np

from rl_tui.programs.evidence.verdict import MovedCell, UpdateTarget
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray

if TYPE_CHECKING:
    from rl_tui.programs.evidence.evidence import Evidence

EXACT: Final = 1e-8
"""Precision below which a table has doubles."""
_FIRST: Final = 4_000
_SURPRISING: Final = 5_000
_MOVING: Final = 8_000
_OTHERS: Final = 2_000
_RUN: Final = 40
"""Length of chosen runs of steps. Some hypotheses compare steps of one episode or cell."""
_COLUMN_CELLS: Final = 400_000
"""Most cells read for the maxima of columns."""


@dataclass(frozen=True)
class Sample:
    """n steps with at most one moving cell, at `place`, and the parts of its new value.

    Attributes:
        at: Indexes in the evidence, `[n]`.
        reward: Reward of the step that the cell belongs to, `[n]`.
        reward_before: Reward of the previous step, `[n]`.
        ended: True if the step terminated, `[n]`.
        next_action: Action taken next, −1 at an end, `[n]`.
        rows: Row of the next state before the step, `[n, A]`.
    """

    evidence: Evidence
    place: MovedCell
    at: IntArray
    cell: IntArray
    old: FloatArray
    new: FloatArray
    reward: FloatArray
    reward_before: FloatArray
    ended: BoolArray
    next_state: IntArray
    next_action: IntArray
    rows: FloatArray

    def __len__(self) -> int:
        return len(self.at)

    @cached_property
    def change(self) -> FloatArray:
        """Change of the cell, `[n]`."""
        return self.new - self.old

    @cached_property
    def slack(self) -> FloatArray:
        """Tolerance of predictions, `[n]`."""
        precision = self.evidence.precision
        part = 1e-6 if precision < EXACT else 0.05  # old and new may be 0 by cancellation
        largest = np.maximum(np.abs(self.old), np.abs(self.new))
        largest = np.maximum(largest, part * np.maximum(np.abs(self.reward), np.abs(self.best)))
        result: FloatArray = np.maximum(largest, 1e-280) * precision
        return result

    @cached_property
    def best(self) -> FloatArray:
        """Greatest next value, max Q(s′), `[n]`."""
        result: FloatArray = self.rows.max(1)
        return result

    def value(self, target: UpdateTarget) -> FloatArray:
        """Return the value that `target` reads, `[n]`, NaN if not computed."""
        if target is UpdateTarget.BEST:
            return self.best
        if target is UpdateTarget.NEXT_ACTION:
            return self._of_actions(np.maximum(self.next_action, 0))
        if target is UpdateTarget.EXPECTED:
            mean: FloatArray = self.rows.mean(1)
            return mean
        if target is UpdateTarget.SAME_ACTION:
            return self._of_actions(self.cell % self.evidence.actions)
        if target is UpdateTarget.OWN_STATE:
            own: FloatArray = self.evidence.rows(self.cell // self.evidence.actions, self.at).max(1)
            return own
        if target is UpdateTarget.INDEX:
            index: FloatArray = self.rows.argmax(1).astype(np.float64)
            return index
        if target is UpdateTarget.COLUMN:
            return self._column_maxima()
        if target is UpdateTarget.OTHER_BEST:
            others: FloatArray = self.other_rows.max(1)
            return others
        if target is UpdateTarget.BEST_BY_OTHER:
            return value_of_choice(self.rows, self.other_rows)
        if target is UpdateTarget.OTHERS_CHOICE:
            return value_of_choice(self.other_rows, self.rows)
        return np.zeros(len(self))

    @cached_property
    def other_rows(self) -> FloatArray:
        """`rows` of the other of two tables."""
        return self.evidence.other_rows(self.next_state, self.at)

    def _of_actions(self, action: IntArray) -> FloatArray:
        values: FloatArray = self.rows[np.arange(len(self)), action]
        return values

    def _column_maxima(self) -> FloatArray:
        states = len(self.evidence.initial) // self.evidence.actions
        some = np.flatnonzero(self.change)[: max(50, _COLUMN_CELLS // max(states, 1))]
        result = np.full(len(self), np.nan)
        result[some] = self.evidence.column_maxima(self.cell[some] % self.evidence.actions, self.at[some])
        return result


def value_of_choice(choosing: FloatArray, judging: FloatArray) -> FloatArray:
    """Return the entry of `judging`, `[n, A]`, of the best action in `choosing`, NaN for different ties."""
    is_best = choosing == choosing.max(1, keepdims=True)
    low = np.where(is_best, judging, np.inf).min(1)
    high = np.where(is_best, judging, -np.inf).max(1)
    result: FloatArray = np.where(low == high, low, np.nan)
    return result


def sample_of(evidence: Evidence, place: MovedCell) -> Sample:
    """Choose the steps on which an update of the cell at `place` is tested.

    Left out are episodes without a change, truncated steps, abandoned episodes (with an unknown next action),
    and steps that moved other cells.
    """
    moved, before, after = evidence.only_change
    cell = place_of(evidence, place)
    late = place is MovedCell.ONE_LATE
    fit = evidence.learns & ((moved == cell) | evidence.stays) & (cell >= 0)
    fit &= evidence.next_state * evidence.actions < len(evidence.initial)
    fit &= (evidence.terminated | evidence.has_next) & ~evidence.truncated
    fit &= evidence.number < evidence.runs_away_at
    fit[-1:] = False  # its change may not have arrived
    at = _chosen(evidence, np.flatnonzero(fit), moved >= 0)
    still = moved[at] < 0
    stood = evidence.history.before(cell[at], evidence.number[at])
    state = evidence.state[at] if late else evidence.next_state[at]
    return Sample(
        evidence,
        place,
        at,
        cell[at],
        np.where(still, stood, before[at]),
        np.where(still, stood, after[at]),
        evidence.reward_before[at] if late else evidence.reward[at],
        evidence.reward[at] if late else evidence.reward_before[at],
        np.zeros(len(at), np.bool_) if late else evidence.terminated[at],
        state,
        evidence.action[at] if late else evidence.next_action[at],
        evidence.rows(state, at),
    )


def place_of(evidence: Evidence, place: MovedCell) -> IntArray:
    """Return the cell at `place` of each step, `[N]`, or −1."""
    if place is MovedCell.TAKEN:
        return evidence.cell
    if place is MovedCell.MOVED:
        return evidence.next_state * evidence.actions + evidence.action
    return evidence.previous_cell


def _chosen(evidence: Evidence, fit: IntArray, moves: BoolArray) -> IntArray:
    if len(fit) <= _FIRST + _SURPRISING + _MOVING + _OTHERS:
        return fit
    moving = moves[fit]
    surprising = (evidence.reward != evidence.reward_before)[fit] | evidence.terminated[fit]
    chosen = np.zeros(len(evidence), np.bool_)
    chosen[fit[:_FIRST]] = True
    chosen[_spread(fit[surprising], _SURPRISING)] = True
    chosen[_spread(fit[moving], _MOVING)] = True
    chosen[_spread(fit[~moving], _OTHERS)] = True
    return np.flatnonzero(chosen)


def _spread(places: IntArray, most: int) -> IntArray:
    if len(places) <= most:
        return places
    starts = np.linspace(0, len(places) - _RUN, most // _RUN).astype(np.int64)
    result: IntArray = places[(starts[:, None] + np.arange(_RUN)).ravel()]
    return result
