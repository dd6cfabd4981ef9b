"""The recording of a watched program: its steps and table changes, in bounded memory."""

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
    """N rows in columns of the types `dtypes`. Results of `views` never change. Up to `room` rows nothing
    is moved, and unused room takes no memory.
    """

    def __init__(self, dtypes: Sequence[npt.DTypeLike], room: int = 0) -> None:
        self._rooms = [np.empty(room, dtype) for dtype in dtypes]
        self._length = 0

    def __len__(self) -> int:
        return self._length

    def add(self, parts: Sequence[npt.NDArray[Any]]) -> None:
        """Append `parts`, an array of equal length for each column."""
        end = self._length + len(parts[0])
        if end > len(self._rooms[0]):
            self._move(0, 2 * end)
        for column, part in zip(self._rooms, parts, strict=True):
            column[self._length : end] = part
        self._length = end

    def views(self) -> list[npt.NDArray[Any]]:
        """Return the columns so far."""
        return [column[: self._length] for column in self._rooms]

    def frozen(self) -> Columns:
        """Return a snapshot for another thread."""
        frozen = Columns(())
        frozen._rooms, frozen._length = self.views(), self._length
        return frozen

    def forget(self, first: int) -> None:
        """Drop the `first` rows."""
        self._move(first, len(self._rooms[0]))

    def clear(self) -> None:
        """Drop all rows."""
        self.forget(self._length)

    def _move(self, first: int, room: int) -> None:
        """Move the rows from `first` on to new memory of `room` rows."""
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
    """N steps as columns, `[N]` each, oldest first."""

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
    """From 0 within the episode."""


class ChangeColumns(NamedTuple):
    """M changes of the table as columns, `[M]` each, oldest first."""

    step: IntArray
    """Step of the change, from 0 over the program."""
    cell: IntArray
    """State · A + action."""
    before: FloatArray
    """Old value, NaN for a missing entry."""
    after: FloatArray


class Recording:
    """The steps and changes of a program. With more than `most` steps, or four times as many changes, the
    older half is dropped, and `initial` becomes the table at that time.

    Attributes:
        first: Number of the first stored step.
        actions: Number of actions, A.
        found_at: Step at which the table was found.
        initial: The table at `found_at`, `[S·A]`, NaN for missing entries, or None.
        has_own_ends: True if a terminal step may be stopped by a limit of the program's own.
    """

    def __init__(self, most: int = MOST_STEPS) -> None:
        self.first = 0
        self.count = 0
        """Number of steps taken."""
        self.actions = 0
        self.found_at = 0
        self.initial: FloatArray | None = None
        self.has_own_ends = False
        self.rebound: list[int] = []
        """Steps after which another object was the table."""
        self._most, self._most_changes = most, most * _CHANGES_OF_A_STEP
        room = most + _ROOM_FOR_A_BATCH
        self._steps, self._changes = Columns(_STEP_TYPES, room), Columns(_CHANGE_TYPES, room)
        self._latest = np.empty(0)
        self._keyframes: list[tuple[int, FloatArray]] = []

    def find_table(self, step: int, actions: int, content: FloatArray) -> None:
        """Begin with the table `content`, `[S·A]`, as it was before `step`."""
        self.found_at, self.actions, self.initial = step, actions, content
        self._latest = content.copy()
        self._changes.clear()
        self._keyframes.clear()

    def add(self, steps: Doubles, changes: Doubles) -> None:
        """Add steps, `[n, 8]`, and changes, `[m, 4]`, as received."""
        if len(steps):
            self._steps.add(_columns(steps.reshape(-1, STEP_WIDTH)))
            self.count += len(steps)
        if len(changes):
            step, cell, before, after = changes.reshape(-1, CHANGE_WIDTH).T
            self._changes.add((step, cell, before, after))
            self._keep_latest(cell.astype(np.int64), after)
        if len(self._steps) > self._most or len(self._changes) > self._most_changes:
            self._forget()

    @property
    def steps(self) -> StepColumns:
        """All stored steps."""
        return StepColumns(*self._steps.views())

    @property
    def changes(self) -> ChangeColumns:
        """All changes of stored steps."""
        return ChangeColumns(*self._changes.views())

    def table_at(self, step: int) -> FloatArray:
        """Return the table after `step` steps, `[S·A]`, NaN for missing entries.

        Raises:
            ValueError: No table was found, or the step is no longer stored.
        """
        if self.initial is None:
            raise ValueError("no table was found")
        if step < self.first:
            raise ValueError(f"step {step} is not kept any more")
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
        """Return a snapshot for another thread."""
        frozen = copy(self)
        frozen._steps, frozen._changes = self._steps.frozen(), self._changes.frozen()
        frozen._latest, frozen._keyframes = self._latest.copy(), list(self._keyframes)
        frozen.rebound = list(self.rebound)
        return frozen

    def _keep_latest(self, cell: IntArray, after: FloatArray) -> None:
        """Update the latest table, and store keyframes from which others are computed."""
        if self.initial is not None:
            self._latest[cell] = after
            last = self._keyframes[-1][0] if self._keyframes else 0
            if len(self._changes) - last >= max(BETWEEN_KEYFRAMES, 8 * len(self._latest)):
                self._keyframes.append((len(self._changes), self._latest.copy()))

    def _forget(self) -> None:
        steps, changes = len(self._steps), self.changes
        keep_from = self.first + steps // 2
        if len(changes.step) > self._most_changes:
            keep_from = max(keep_from, int(changes.step[len(changes.step) // 2]) + 1)
        until = int(np.searchsorted(changes.step, keep_from))
        if self.initial is not None:
            self.initial = self.table_at(keep_from)
            self.found_at = max(self.found_at, keep_from)
        self._changes.forget(until)
        self._steps.forget(min(keep_from - self.first, steps))
        self._keyframes = [(place - until, table) for place, table in self._keyframes if place >= until]
        self.rebound = [each for each in self.rebound if each >= keep_from]
        self.first = min(keep_from, self.first + steps)


def _columns(table: Doubles) -> list[npt.NDArray[Any]]:
    environment, state, action, reward, next_state, flags, episode, episode_step = table.T
    said = flags.astype(np.int64)
    terminated, truncated = (said & StepFlag.TERMINATED) != 0, (said & StepFlag.TRUNCATED) != 0
    return [environment, state, action, reward, next_state, terminated, truncated, episode, episode_step]
