"""The steps and table changes of a program, in bounded memory."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from copy import copy
from typing import Any, Final, NamedTuple

import numpy as np
import numpy.typing as npt

from rl_tui.programs.watched.messages import CHANGE_WIDTH, STEP_WIDTH, StepFlag
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray

# Columns that grow and forget


class Columns:
    """N rows in columns. Results of `views` never change. Up to `room` rows nothing is moved."""

    def __init__(self, dtypes: Sequence[npt.DTypeLike], room: int = 0) -> None:
        self._rooms = [np.empty(room, dtype) for dtype in dtypes]
        self._length = 0

    def add(self, parts: Sequence[npt.NDArray[Any]]) -> None:
        """Append an array of equal length for each column."""
        end = self._length + len(parts[0])
        if end > len(self._rooms[0]):
            self._move(0, 2 * end)
        for column, part in zip(self._rooms, parts, strict=True):
            column[self._length : end] = part
        self._length = end

    def views(self) -> list[npt.NDArray[Any]]:
        """Return the columns so far."""
        return [column[: self._length] for column in self._rooms]

    def forget(self, first: int) -> None:
        """Drop the `first` rows."""
        self._move(first, len(self._rooms[0]))

    def _move(self, first: int, room: int) -> None:
        kept = [column[first : self._length] for column in self._rooms]
        self._rooms = [np.empty(room, column.dtype) for column in kept]
        self._length -= first
        for column, part in zip(self._rooms, kept, strict=True):
            column[: self._length] = part


# The recording


MOST_STEPS: Final = 4_000_000
"""Most stored steps. Beyond that, the older half is dropped."""

_CHANGES_OF_A_STEP: Final = 4  # on average, for each stored step
_ROOM_FOR_A_BATCH: Final = 200_000  # steps; a batch rarely has more
BETWEEN_KEYFRAMES: Final = 100_000  # changes
_STEP_TYPES: Final = (*[np.int64] * 3, np.float64, np.int64, np.bool_, np.bool_, np.int64, np.int64)
_CHANGE_TYPES: Final = (np.int64, np.int64, np.float64, np.float64)

Doubles = npt.NDArray[np.float64]


class StepColumns(NamedTuple):
    """N steps, `[N]` each, oldest first."""

    environment: IntArray
    state: IntArray
    action: IntArray
    reward: FloatArray
    next_state: IntArray
    terminated: BoolArray
    truncated: BoolArray
    episode: IntArray
    """From 0 over all environments, in the order of their beginnings."""
    episode_step: IntArray


class ChangeColumns(NamedTuple):
    """M changes of the table, `[M]` each, oldest first."""

    step: IntArray
    cell: IntArray
    before: FloatArray
    """Old value, NaN for a missing entry."""
    after: FloatArray


class Recording:
    """The steps and changes of a program.

    With more than `most` steps, or four times as many changes, the older half is dropped, and `initial`
    becomes the table at that time. If two tables change in turn, their mean is the table, and both are
    recorded, too.

    Attributes:
        first: Number of the first stored step.
        found_at: Step at which the table was found.
        initial: The table then, `[S·A]`, NaN for missing entries, or None.
        paired_at: Step from which both tables are recorded.
        initial_pair: Both tables then, `[2·S·A]`, or None for a single one.
        changes_of_pair: Changes of both tables. Cells of the second count from S·A.
        has_own_ends: True if a limit of the program's own may stop a terminal step.
    """

    def __init__(self, most: int = MOST_STEPS) -> None:
        self.first = 0
        self.count = 0
        self.actions = 0
        self.found_at = 0
        self.initial: FloatArray | None = None
        self.paired_at = 0
        self.initial_pair: FloatArray | None = None
        self.has_own_ends = False
        self.rebound: list[int] = []
        """Steps after which another object was the table."""
        self._most, self._most_changes = most, most * _CHANGES_OF_A_STEP
        room = most + _ROOM_FOR_A_BATCH
        self._steps, self._changes = Columns(_STEP_TYPES, room), Columns(_CHANGE_TYPES, room)
        self._of_pair = Columns(_CHANGE_TYPES)
        self._latest = np.empty(0)
        self._keyframes: list[tuple[int, FloatArray]] = []
        self._view()

    def _view(self) -> None:
        self.steps = StepColumns._make(self._steps.views())
        self.changes = ChangeColumns._make(self._changes.views())
        self.changes_of_pair = ChangeColumns._make(self._of_pair.views())

    def find_table(self, step: int, actions: int, content: FloatArray) -> None:
        """Begin with the table `content`, `[S·A]`, as before `step`."""
        self.found_at, self.actions, self.initial = step, actions, content
        self._latest, self.initial_pair = content.copy(), None
        self._changes.forget(len(self.changes.step))
        self._keyframes.clear()
        self._view()

    def find_pair(self, step: int, content: FloatArray) -> None:
        """Begin with two tables, `[2·S·A]`, at `step`."""
        if len(content) != 2 * len(self._latest):
            raise ValueError("the tables are damaged")
        self.paired_at, self.initial_pair = step, content
        self._of_pair.forget(len(self.changes_of_pair.step))
        self._view()

    def add(self, steps: Doubles, changes: Doubles) -> None:
        """Add steps, `[n, 8]`, and changes, `[m, 4]`, as received."""
        if len(steps):
            environment, state, action, reward, next_state, flags, *rest = steps.reshape(-1, STEP_WIDTH).T
            said = flags.astype(np.int64)
            ends = (said & StepFlag.TERMINATED) != 0, (said & StepFlag.TRUNCATED) != 0
            self._steps.add((environment, state, action, reward, next_state, *ends, *rest))
            self.count += len(steps)
        if self.initial_pair is not None and len(changes):
            changes = self._without_pair(changes.reshape(-1, CHANGE_WIDTH))
        if len(changes):
            step, cell, before, after = changes.reshape(-1, CHANGE_WIDTH).T
            self._changes.add((step, cell, before, after))
            self._view()
            self._keep_latest(cell.astype(np.int64), after)
        else:
            self._view()
        if len(self.steps.state) > self._most or len(self.changes.step) > self._most_changes:
            self._forget()

    def table_at(self, step: int) -> FloatArray:
        """Return the table after `step` steps, `[S·A]`, NaN for missing entries, or raise ValueError."""
        if self.initial is None:
            raise ValueError("no table was found")
        if step < self.first:
            raise ValueError(f"step {step} is no longer kept")
        changes = self.changes
        until = int(np.searchsorted(changes.step, step))  # the changes of the first `step` steps
        if until == len(changes.step):
            return self._latest.copy()
        place = bisect_right(self._keyframes, until, key=lambda keyframe: keyframe[0])
        begin, table = self._keyframes[place - 1] if place else (0, self.initial)
        table = table.copy()
        table[changes.cell[begin:until]] = changes.after[
            begin:until
        ]  # the last of several changes of a cell counts
        return table

    def frozen(self) -> Recording:
        """Return a fixed snapshot for another thread."""
        frozen = copy(self)
        frozen._latest, frozen._keyframes = self._latest.copy(), list(self._keyframes)
        frozen.rebound = list(self.rebound)
        return frozen

    def _without_pair(self, changes: Doubles) -> Doubles:
        cells = len(self._latest)
        step, cell, before, after = changes[changes[:, 1] >= cells].T
        self._of_pair.add((step, cell - cells, before, after))
        return changes[changes[:, 1] < cells]

    def _keep_latest(self, cell: IntArray, after: FloatArray) -> None:
        if self.initial is not None:
            self._latest[cell] = after
            last, count = self._keyframes[-1][0] if self._keyframes else 0, len(self.changes.step)
            if count - last >= max(BETWEEN_KEYFRAMES, 8 * len(self._latest)):
                self._keyframes.append((count, self._latest.copy()))

    def _forget(self) -> None:
        steps, changes = len(self.steps.state), self.changes
        keep_from = self.first + steps // 2
        if len(changes.step) > self._most_changes:
            keep_from = max(keep_from, int(changes.step[len(changes.step) // 2]) + 1)
        until = int(np.searchsorted(changes.step, keep_from))
        if self.initial is not None:
            self.initial = self.table_at(keep_from)
            self.found_at = max(self.found_at, keep_from)
        if self.initial_pair is not None and keep_from > self.paired_at:
            changes = self.changes_of_pair
            gone = int(np.searchsorted(changes.step, keep_from))
            self.initial_pair = self.initial_pair.copy()
            self.initial_pair[changes.cell[:gone]] = changes.after[:gone]
            self.paired_at = keep_from
            self._of_pair.forget(gone)
        self._changes.forget(until)
        self._steps.forget(min(keep_from - self.first, steps))
        self._view()
        self._keyframes = [(place - until, table) for place, table in self._keyframes if place >= until]
        self.rebound = [each for each in self.rebound if each >= keep_from]
        self.first = min(keep_from, self.first + steps)
