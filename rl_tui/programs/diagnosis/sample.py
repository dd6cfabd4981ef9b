"""A bounded, reproducible choice of steps for testing hypotheses."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Final

import numpy as np

from rl_tui.programs.evidence.verdict import MovedCell, UpdateTarget
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray

if TYPE_CHECKING:
    from rl_tui.programs.diagnosis.step_story import TableBefore
    from rl_tui.programs.evidence.evidence import Evidence

EXACT: Final = 1e-8
"""Precision below which a table has doubles."""
_FIRST: Final = 4_000
_SURPRISING: Final = 5_000
_MOVING: Final = 8_000
_OTHERS: Final = 2_000
_RUN: Final = 40
"""Length of chosen runs of steps. Some hypotheses compare steps of one episode or cell."""
_MOST_CELLS: Final = 2_000_000
_MOST_CELLS_OF_A_SAMPLE: Final = 400_000


@dataclass(frozen=True)
class ReadEstimates:
    """The estimates that the updates of n steps may read.

    Attributes:
        at: Indexes in the evidence, `[n]`.
        state: State of the updated cell, `[n]`.
        action: Action of the updated cell, `[n]`.
        next_action: Action taken next, −1 if unknown, `[n]`.
    """

    evidence: Evidence | TableBefore
    at: IntArray
    state: IntArray
    action: IntArray
    next_state: IntArray
    next_action: IntArray

    def __len__(self) -> int:
        return len(self.at)

    @cached_property
    def rows(self) -> FloatArray:
        """Row of the next state before the step, `[n, A]`."""
        return self.evidence.rows(self.next_state, self.at)

    @cached_property
    def other_rows(self) -> FloatArray:
        """`rows` of the other of two tables."""
        return self.evidence.other_rows(self.next_state, self.at)

    def values(self, target: UpdateTarget, epsilon: float | None = None) -> FloatArray:
        """Return the values that `target` may read, `[n, K]`.

        K > 1 if only the program knows which, because it is not known which action was taken, allowed or
        best. `epsilon` is that of Expected SARSA, NaN if None.
        """
        values: FloatArray
        match target:
            case UpdateTarget.BEST:
                values = self.rows.max(1)
            case UpdateTarget.NEXT_ACTION:
                values = np.where(
                    self.next_action[:, None] >= 0, _of_actions(self.rows, self.next_action), self.rows
                )
            case UpdateTarget.EXPECTED:
                best = self.rows.max(1)
                values = best + (np.nan if epsilon is None else epsilon) * (self.rows.mean(1) - best)
            case UpdateTarget.ALLOWED | UpdateTarget.DRAWN:
                values = self.rows
            case UpdateTarget.COLUMN:
                some = self._with_column()
                values = np.full(len(self), np.nan)
                values[some] = self.evidence.column_maxima(self.action[some], self.at[some])
            case UpdateTarget.SAME_ACTION:
                values = _of_actions(self.rows, self.action)
            case UpdateTarget.OWN_STATE:
                values = self.evidence.rows(self.state, self.at).max(1)
            case UpdateTarget.INDEX:
                values = self.rows.argmax(1).astype(np.float64)
            case UpdateTarget.OTHER_BEST:
                values = self.other_rows.max(1)
            case UpdateTarget.BEST_BY_OTHER:
                values = _of_best(self.rows, self.other_rows)
            case UpdateTarget.OTHERS_CHOICE:
                values = _of_best(self.other_rows, self.rows)
            case UpdateTarget.NOTHING:
                values = np.zeros(len(self))
        return values if values.ndim == 2 else values[:, None]

    def _with_column(self) -> IntArray:
        return np.arange(len(self))[: _MOST_CELLS // max(self.evidence.states, 1)]


def _of_actions(rows: FloatArray, action: IntArray) -> FloatArray:
    values: FloatArray = np.take_along_axis(rows, np.maximum(action, 0)[:, None], 1)
    return values


def _of_best(choosing: FloatArray, judging: FloatArray) -> FloatArray:
    """Return the entries of `judging`, `[n, A]`, of the best actions in `choosing`, repeated for others."""
    is_best = choosing == choosing.max(1, keepdims=True)
    return np.where(is_best, judging, _of_actions(judging, is_best.argmax(1)))


@dataclass(frozen=True)
class Sample(ReadEstimates):
    """n steps with at most one moving cell, at `place`, and the parts of its new value.

    Attributes:
        reward: Reward of the step that the cell belongs to, `[n]`.
        reward_before: Reward of the previous step, `[n]`.
        ended: True if the step terminated, `[n]`.
    """

    evidence: Evidence
    place: MovedCell
    old: FloatArray
    new: FloatArray
    reward: FloatArray
    reward_before: FloatArray
    ended: BoolArray

    @property
    def cell(self) -> IntArray:
        """The updated cell, `[n]`."""
        return self.state * self.evidence.actions + self.action

    @cached_property
    def change(self) -> FloatArray:
        """Change of the cell, `[n]`."""
        return self.new - self.old

    @property
    def unit(self) -> FloatArray:
        """Part of the change for each α without a next value, `[n]`."""
        unit: FloatArray = self.reward - self.old
        return unit

    @property
    def digits(self) -> int:
        """Significant digits of numbers solved from single steps."""
        return 6 if self.evidence.precision < EXACT else 3

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
        """Return the value that `target` reads, `[n]`, NaN if it is one of several, or not computed."""
        values = self.values(target)
        return np.where((values == values[:, :1]).all(1), values[:, 0], np.nan)

    def next_value(self, target: UpdateTarget) -> FloatArray:
        """Return the same, but 0 at an end."""
        return np.where(self.ended, 0.0, self.value(target))

    def _with_column(self) -> IntArray:
        return np.flatnonzero(self.change)[: max(50, _MOST_CELLS_OF_A_SAMPLE // max(self.evidence.states, 1))]


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
        at,
        *np.divmod(cell[at], evidence.actions),
        state,
        evidence.action[at] if late else evidence.next_action[at],
        place,
        np.where(still, stood, before[at]),
        np.where(still, stood, after[at]),
        evidence.reward_before[at] if late else evidence.reward[at],
        evidence.reward[at] if late else evidence.reward_before[at],
        np.zeros(len(at), np.bool_) if late else evidence.terminated[at],
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
