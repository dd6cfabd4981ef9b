"""The steps of a program as columns, prepared for hypotheses about its update."""

from __future__ import annotations

from functools import cached_property
from typing import Final

import numpy as np

from rl_tui.programs.watched.recording import ChangeColumns, Recording
from rl_tui.worlds.mdp.space import BoolArray, FloatArray, IntArray

NO_ACTION: Final = -1
_TOO_LARGE: Final = 1e100
_FEW: Final = 1 << 16
_JUDGED: Final = 20_000
"""Number of changes from which the precision of a table is estimated."""


def order_by(keys: IntArray) -> IntArray:
    """Return a stable sort order of nonnegative `keys`."""
    small = len(keys) > 0 and int(keys.max()) < _FEW
    order: IntArray = np.argsort(keys.astype(np.uint16) if small else keys, kind="stable")
    return order


class TableHistory:
    """The table at any moment, for many cells and steps at once. `initial`, `[S·A]`, has no NaN, and
    `span` exceeds any step.
    """

    def __init__(self, initial: FloatArray, changes: ChangeColumns, span: int) -> None:
        self._initial = initial
        order = order_by(changes.cell)
        self._span = span
        self._key = changes.cell[order] * span + changes.step[order]
        self._cell, self._after = changes.cell[order], changes.after[order]

    def before(self, cell: IntArray, step: IntArray) -> FloatArray:
        """Return the value in each `cell` before `step`, arrays of equal shape. A missing entry of a dict
        has the value that it began with. A cell of another environment is clipped to the last one.
        """
        value: FloatArray = self._initial.take(cell, mode="clip")
        if len(self._cell):
            place = np.searchsorted(self._key, cell * self._span + step) - 1
            known = self._cell.take(place, mode="clip") == cell
            value = np.where(known & (place >= 0), self._after.take(place, mode="clip"), value)
        return value


class Evidence:
    """The N steps since the table was found, oldest first. `number` has their numbers in the program.
    `reward_before` is the reward of the program's previous step (0 at first), `next_action` the next
    action in the episode (−1 if none), `previous_cell` the previous cell in the episode (−1 if none).
    `initial`, `[S·A]`, is the table at the first step, and `changes` are all changes of numbers since.
    """

    def __init__(self, recording: Recording) -> None:
        if recording.initial is None:
            raise ValueError("no table was found")
        self.recording = recording
        self.actions = recording.actions
        steps = recording.steps
        begin = max(recording.found_at - recording.first, 0)
        self.number: IntArray = np.arange(begin, len(steps.state)) + recording.first
        cut = slice(begin, None)
        self.state, self.action = steps.state[cut], steps.action[cut]
        self.reward, self.next_state = steps.reward[cut], steps.next_state[cut]
        self.terminated, self.truncated = steps.terminated[cut], steps.truncated[cut]
        self.episode, self.episode_step = steps.episode[cut], steps.episode_step[cut]
        self.environment = steps.environment[cut]
        self.cell: IntArray = self.state * self.actions + self.action
        self.reward_before = np.concatenate(([0.0], steps.reward))[begin:-1]
        self.next_action, self.previous_cell = self._neighbours()
        self.initial, self.changes = _settled(recording, self.cell, int(self.number[0]) if len(self) else 0)
        self.history = TableHistory(self.initial, self.changes, recording.count + 2)

    def __len__(self) -> int:
        return len(self.number)

    def _neighbours(self) -> tuple[IntArray, IntArray]:
        """Return the next action and the previous cell of each step within its episode."""
        next_action: IntArray = np.full(len(self), NO_ACTION)
        previous_cell: IntArray = np.full(len(self), NO_ACTION)
        if len(self) < 2 or np.all(self.episode[1:] >= self.episode[:-1]):
            follows = self.episode[1:] == self.episode[:-1]
            np.copyto(next_action[:-1], self.action[1:], where=follows)
            np.copyto(previous_cell[1:], self.cell[:-1], where=follows)
            return next_action, previous_cell
        order = np.lexsort((self.number, self.episode))  # episodes of several environments alternate
        follows = self.episode[order][1:] == self.episode[order][:-1]
        next_action[order[:-1][follows]] = self.action[order[1:][follows]]
        previous_cell[order[1:][follows]] = self.cell[order[:-1][follows]]
        return next_action, previous_cell

    @cached_property
    def _at(self) -> IntArray:
        """Index of the step of each change, −1 if it is not included."""
        if not len(self):
            return np.full(len(self.changes.step), -1)
        place = self.changes.step - self.number[0]
        at: IntArray = np.where((place >= 0) & (place < len(self)), place, -1)
        return at

    @property
    def has_next(self) -> BoolArray:
        """True if the next action in the episode is known, `[N]`."""
        has_next: BoolArray = self.next_action != NO_ACTION
        return has_next

    @cached_property
    def runs_away_at(self) -> float:
        """First step with a number too large for sums, infinite if there is none."""
        changes = self.recording.changes
        large = np.abs(changes.after) >= _TOO_LARGE
        return float(changes.step[large].min()) if large.any() else np.inf

    @cached_property
    def changes_of(self) -> IntArray:
        """Number of cells that each step changed, `[N]`."""
        counted: IntArray = np.bincount(self._at[self._at >= 0], minlength=len(self))
        return counted

    @cached_property
    def only_change(self) -> tuple[IntArray, FloatArray, FloatArray]:
        """Cell, old and new value of each step that changed one cell, else −1, 0, 0."""
        cell: IntArray = np.full(len(self), -1)
        before, after = np.zeros(len(self)), np.zeros(len(self))
        if len(self):
            single = (self.changes_of[self._at] == 1) & (self._at >= 0)
            at = self._at[single]
            cell[at] = self.changes.cell[single]
            before[at] = self.changes.before[single]
            after[at] = self.changes.after[single]
        return cell, before, after

    @cached_property
    def learns(self) -> BoolArray:
        """True for steps of episodes with a change, `[N]`. Other episodes may be evaluations."""
        if not len(self):
            return np.empty(0, np.bool_)
        first = int(self.episode.min())
        changed = np.zeros(int(self.episode.max()) - first + 1, np.bool_)
        changed[self.episode[self.changes_of > 0] - first] = True
        result: BoolArray = changed[self.episode - first]
        return result

    @cached_property
    def visits(self) -> tuple[IntArray, IntArray]:
        """Visits of each step's cell so far, including this step, `[N]`: over all steps, and over episodes
        with changes only.
        """
        order = order_by(self.cell)
        cell = self.cell[order]
        begins = np.flatnonzero(np.diff(cell, prepend=-1))
        lengths = np.diff(np.append(begins, len(order)))
        place = np.arange(len(order))
        counted = np.cumsum(self.learns[order])
        before: IntArray = counted[begins] - self.learns[order[begins]]
        every: IntArray = np.empty(len(order), np.int64)
        learning: IntArray = np.empty(len(order), np.int64)
        every[order] = place - np.repeat(begins, lengths) + 1
        learning[order] = counted - np.repeat(before, lengths)
        return every, learning

    @cached_property
    def precision(self) -> float:
        """Relative precision of the table. Closer numbers may be equal."""
        after = self.changes.after[-_JUDGED:]
        after = after[np.abs(after) < 6e4]  # a half float has no larger number
        with np.errstate(all="ignore"):
            if len(after) and np.array_equal(after, after.astype(np.float16)):
                return 3e-3 if np.any(after != np.rint(after * 16) / 16) else 1e-9
            if len(after) and np.array_equal(after, after.astype(np.float32)):
                return 2e-6
        return 1e-9

    @property
    def whole_numbers(self) -> bool:
        """True if only whole numbers were written to the table."""
        return bool(np.array_equal(self.changes.after, np.rint(self.changes.after)))

    @cached_property
    def surely_ended(self) -> BoolArray:
        """True for terminal steps, `[N]`. If the program's own limit may make a step terminal, only for
        steps into a state from which no step starts.
        """
        if not self.recording.has_own_ends:
            return self.terminated
        ended: BoolArray = self.terminated & ~np.isin(self.next_state, self.recording.steps.state)
        return ended

    def rows(self, state: IntArray, at: IntArray) -> FloatArray:
        """Return the rows of `state`, `[n]`, before the steps at the indexes `at`, `[n]`, as `[n, A]`."""
        cells = state[:, None] * self.actions + np.arange(self.actions)
        steps = np.broadcast_to(self.number[at][:, None], cells.shape)
        return self.history.before(cells, steps)


def _settled(recording: Recording, taken: IntArray, first: int) -> tuple[FloatArray, ChangeColumns]:
    """Return the initial table and the changes without missing entries. A dict makes rows on access, and
    most entries show the initial value of all. With random rows, an entry began with its first value. An
    entry made by a step in its own cell began with 0 instead. `taken`, `[N]`, has the cells of the steps
    from `first` on.
    """
    assert recording.initial is not None
    initial, changes = recording.initial, recording.changes
    kept = (changes.step >= first) if len(taken) else np.zeros(len(changes.step), np.bool_)
    changes = ChangeColumns._make(column[kept] for column in changes) if not kept.all() else changes
    before, now = changes.before, np.nan_to_num(changes.after)  # a deleted entry counts as 0
    missing = np.isnan(before)
    if missing.any():
        made = np.flatnonzero(missing)
        step, after = changes.step[made], now[made]
        of_row = np.zeros(len(made), np.bool_)
        of_row[1:] = step[1:] == step[:-1]
        of_row[:-1] |= of_row[1:]
        values, counts = np.unique(after[of_row], return_counts=True)
        if not len(values) or 2 * counts.max() > counts.sum():
            usual = float(values[np.argmax(counts)]) if len(values) else 0.0
            initial, before = np.where(np.isnan(initial), usual, initial), np.where(missing, usual, before)
        else:
            looked_up = taken.take(step - first, mode="clip") != changes.cell[made]
            began = np.where(looked_up, after, 0.0)
            initial, before = initial.copy(), before.copy()
            initial[changes.cell[made[::-1]]] = began[::-1]  # the first of several counts
            before[made] = began
    moved = before != now
    settled = ChangeColumns(changes.step, changes.cell, before, now)
    if not moved.all():
        settled = ChangeColumns._make(column[moved] for column in settled)
    return np.nan_to_num(initial), settled
