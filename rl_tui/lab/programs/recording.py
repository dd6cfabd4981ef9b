"""What a watched program did: its steps, and every change of its table, in bounded memory."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

from rl_tui.lab.programs.messages import CHANGE_WIDTH, STEP_WIDTH, StepFlag
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray

MOST_STEPS: Final = 4_000_000
"""Steps that are kept; when there are more the older half is forgotten."""

Doubles = npt.NDArray[np.float64]


class Steps(NamedTuple):
    """N steps as columns, [N] each, oldest first."""

    environment: IntArray
    state: IntArray
    action: IntArray
    reward: FloatArray
    next_state: IntArray
    terminated: BoolArray
    truncated: BoolArray
    episode: IntArray
    """From 0, over all environments, in the order in which episodes began."""
    episode_step: IntArray
    """From 0 within its episode."""


class Changes(NamedTuple):
    """M changes of the table as columns, [M] each, oldest first."""

    step: IntArray
    """To which step it belongs, as the program counts them from 0."""
    cell: IntArray
    """State · A + action."""
    before: FloatArray
    """NaN where the table had no such entry."""
    after: FloatArray


class Recording:
    """The steps and changes of a program so far; ``first`` is the number of the first step that is kept.

    ``initial`` is the table as it was found at step ``found_at``, [S·A], with NaN where there was no entry;
    None while no table was found. ``actions`` is A.
    """

    def __init__(self, most: int = MOST_STEPS) -> None:
        self.first = 0
        self.count = 0
        """How many steps were taken in all."""
        self.actions = 0
        self.found_at = 0
        self.initial: FloatArray | None = None
        self.rebound: list[int] = []
        """The steps after which another object was the table."""
        self._most = most
        self._steps: list[Steps] = []
        self._changes: list[Changes] = []

    def find_table(self, step: int, actions: int, content: FloatArray) -> None:
        """Take ``content``, [S·A], for the table as it was before step ``step``."""
        self.found_at, self.actions, self.initial = step, actions, content
        self._changes.clear()

    def add(self, steps: Doubles, changes: Doubles) -> None:
        """Add steps, [n, 8], and changes, [m, 4], as they come through the pipe."""
        if len(steps):
            self._steps.append(_columns(steps.reshape(-1, STEP_WIDTH)))
            self.count += len(steps)
        if len(changes):
            table = changes.reshape(-1, CHANGE_WIDTH)
            step, cell = table[:, 0].astype(np.int64), table[:, 1].astype(np.int64)
            self._changes.append(Changes(step, cell, table[:, 2].copy(), table[:, 3].copy()))
        if self.count - self.first > self._most:
            self._forget()

    @property
    def steps(self) -> Steps:
        """All steps that are kept."""
        if len(self._steps) > 1:
            self._steps = [Steps._make(map(np.concatenate, zip(*self._steps, strict=True)))]
        return self._steps[0] if self._steps else _NO_STEPS

    @property
    def changes(self) -> Changes:
        """All changes of the steps that are kept."""
        if len(self._changes) > 1:
            self._changes = [Changes._make(map(np.concatenate, zip(*self._changes, strict=True)))]
        return self._changes[0] if self._changes else _NO_CHANGES

    def table_at(self, step: int) -> FloatArray:
        """Return the table after ``step`` steps, [S·A]; NaN where it has no entry.

        Raises ValueError where no table was found, or that moment is not kept.
        """
        if self.initial is None:
            raise ValueError("no table was found")
        if step < self.first:
            raise ValueError(f"step {step} is not kept any more")
        table, changes = self.initial.copy(), self.changes
        until = int(np.searchsorted(changes.step, step))  # the changes of the first `step` steps
        table[changes.cell[:until]] = changes.after[:until]  # of several of one cell the last one counts
        return table

    def _forget(self) -> None:
        """Forget the older half of the steps; the table as it was then becomes the initial one."""
        drop = len(self.steps.state) // 2
        keep_from = self.first + drop
        changes = self.changes
        if self.initial is not None:
            self.initial = self.table_at(keep_from)
            self.found_at = max(self.found_at, keep_from)
        until = int(np.searchsorted(changes.step, keep_from))
        self._changes = [Changes._make(column[until:].copy() for column in changes)]
        self._steps = [Steps._make(column[drop:].copy() for column in self.steps)]
        self.first = keep_from


def _columns(table: Doubles) -> Steps:
    environment, state, action, reward, next_state, flags, episode, episode_step = table.T
    said = flags.astype(np.int64)
    return Steps(
        environment.astype(np.int64),
        state.astype(np.int64),
        action.astype(np.int64),
        reward.copy(),
        next_state.astype(np.int64),
        (said & StepFlag.TERMINATED) != 0,
        (said & StepFlag.TRUNCATED) != 0,
        episode.astype(np.int64),
        episode_step.astype(np.int64),
    )


_NONE: Final = np.empty(0, np.int64)
_NO_STEPS: Final = Steps(
    _NONE, _NONE, _NONE, np.empty(0), _NONE, np.empty(0, np.bool_), np.empty(0, np.bool_), _NONE, _NONE
)
_NO_CHANGES: Final = Changes(_NONE, _NONE, np.empty(0), np.empty(0))
