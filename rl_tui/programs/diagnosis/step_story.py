"""The moved cells of a step, and the parts of its update."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final, NamedTuple

import numpy as np

from rl_tui.programs.diagnosis.sample import ReadEstimates
from rl_tui.programs.evidence.verdict import MovedCell, Rule, UpdateFound
from rl_tui.programs.watched.recording import Recording
from rl_tui.worlds.mdp.space import FloatArray, IntArray

NOTHING: Final = -1
_NEAR: Final = 1e-5
"""Relative tolerance of an explained change (single precision)."""


class CellChange(NamedTuple):
    """A cell of the program's table, state · A + action."""

    cell: int
    before: float
    after: float


@dataclass(frozen=True, slots=True)
class StepUpdate:
    """The effect of a step on the program's table.

    As in `LastStep`, after = before + step_size · (gathered + discount · bootstrap − before). The parts are
    None if the update is unknown, or the step departs from it. `cell` and `bootstrap_state` are −1 if
    unknown. Steps count from 0.
    """

    step: int
    moved: tuple[CellChange, ...]
    cell: int = NOTHING
    before: float = 0.0
    after: float = 0.0
    step_size: float | None = None
    gathered: float | None = None
    discount: float | None = None
    bootstrap: float | None = None
    bootstrap_state: int = NOTHING

    @property
    def explained(self) -> bool:
        """True if the update explains it."""
        return self.step_size is not None


@dataclass(frozen=True, slots=True)
class TableBefore:
    """The table before the step, `[S, A]`, in place of the evidence of many steps."""

    table: FloatArray

    @property
    def states(self) -> int:
        """S."""
        return len(self.table)

    def rows(self, state: IntArray, _: IntArray) -> FloatArray:
        """Return the rows of `state`."""
        return self.table[state]

    other_rows = rows  # there is no other table

    def column_maxima(self, action: IntArray, _: IntArray) -> FloatArray:
        """Return the maximum over states for `action`."""
        maxima: FloatArray = self.table[:, action].max(0)
        return maxima


def update_of_step(
    recording: Recording, update: UpdateFound, step: int, table: FloatArray | None = None
) -> StepUpdate:
    """Explain a step, from 0, by the update found. `table`, `[S·A]`, is the one before it, if available.

    Raises ValueError if the step or table is not stored.
    """
    place = step - recording.first
    steps, changes = recording.steps, recording.changes
    if not 0 <= place < len(steps.state):
        raise ValueError(f"step {step} is not kept")
    if table is None:
        table = recording.table_at(step)
    table = np.nan_to_num(table)
    low, high = (int(each) for each in np.searchsorted(changes.step, (step, step + 1)))
    moved = tuple(
        CellChange(int(cell), 0.0 if np.isnan(before) else float(before), float(after))
        for cell, before, after in zip(
            changes.cell[low:high], changes.before[low:high], changes.after[low:high], strict=True
        )
    )
    moved = tuple(each for each in moved if each.before != each.after)
    of = place - 1 if update.place is MovedCell.ONE_LATE else place  # the step whose cell moves
    state = steps.next_state[of] if update.place is MovedCell.MOVED else steps.state[of]
    is_known = of == place or (of >= 0 and steps.episode[of] == steps.episode[place])
    cell = int(state) * recording.actions + int(steps.action[of]) if is_known else NOTHING
    if len(moved) > 1 or (moved and cell != moved[0].cell) or not 0 <= cell < len(table):
        only = moved[0] if len(moved) == 1 else None
        return StepUpdate(step, moved, *(only or (NOTHING, 0.0, 0.0)))
    before, after = (moved[0].before, moved[0].after) if moved else (float(table[cell]),) * 2
    bare = StepUpdate(step, moved, cell, before, after)
    is_unknown = update.rule is Rule.UNKNOWN and update.alpha_schedule is None
    if is_unknown or update.rule is Rule.MONTE_CARLO or recording.initial_pair is not None:
        return bare
    return _with_parts(bare, recording, of, update, table.reshape(-1, recording.actions))


def _with_parts(
    bare: StepUpdate, recording: Recording, of: int, update: UpdateFound, table: FloatArray
) -> StepUpdate:
    steps = recording.steps
    reward_of = of - 1 if update.uses_reward_before else of
    if of < 0 or (reward_of < 0 and recording.first > 0):
        return bare
    goes_on = of + 1 < len(steps.state) and steps.episode[of + 1] == steps.episode[of]
    state, ended = int(steps.next_state[of]), bool(steps.terminated[of])
    reads = (steps.state[of], steps.action[of], state, steps.action[of + 1] if goes_on else NOTHING)
    estimates = ReadEstimates(
        TableBefore(table), np.zeros(1, np.int64), *(np.array([each]) for each in reads)
    )
    values = estimates.values(update.target, update.epsilon)[0].tolist()
    if ended:  # some programs bootstrap there anyway
        values = [0.0, *values]
    gamma = update.gamma if update.gamma is not None else 0.0
    reward, change = float(steps.reward[reward_of]) if reward_of >= 0 else 0.0, bare.after - bare.before
    for value in values:
        whole = reward + gamma * value
        alpha = update.alpha
        if alpha is None:
            alpha = change / (whole - bare.before) if whole != bare.before else 0.0
            fits = _possible(alpha, update)
        else:
            if update.reward == "own" and alpha:
                whole = bare.before + change / alpha
            off = abs(bare.before + alpha * (whole - bare.before) - bare.after)
            fits = off <= _NEAR * max(abs(change), 1e-6 * abs(bare.before), 1e-300)
        if fits:
            return replace(
                bare,
                step_size=alpha,
                gathered=whole - gamma * value if update.reward == "own" else reward,
                discount=gamma,
                bootstrap=value,
                bootstrap_state=NOTHING if ended and value == 0.0 else state,
            )
    return bare


def _possible(alpha: float, update: UpdateFound) -> bool:
    if not 0.0 < alpha <= 1.0 + _NEAR:
        return False
    return update.alpha_schedule != "1/N" or abs(1 / alpha - round(1 / alpha)) <= _NEAR / alpha
