"""The steps of a program as columns."""

from __future__ import annotations

from collections.abc import Mapping
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
_TURNS: Final = 4
"""Changes for each switch to the other table, at most, and for each change without a switch."""
_FEWEST_ALIKE: Final = 3


def order_by(keys: IntArray) -> IntArray:
    """Return a stable sort order of nonnegative `keys`."""
    small = len(keys) > 0 and int(keys.max()) < _FEW
    order: IntArray = np.argsort(keys.astype(np.uint16) if small else keys, kind="stable")
    return order


class _TableHistory:
    """The table at any moment. `initial`, `[S·A]`, has no NaN, and `span` exceeds any step."""

    def __init__(self, initial: FloatArray, changes: ChangeColumns, span: int) -> None:
        self._initial = initial
        order = order_by(changes.cell)
        self._span = span
        self._key = changes.cell[order] * span + changes.step[order]
        self._cell, self._after = changes.cell[order], changes.after[order]

    def before(self, cell: IntArray, step: IntArray) -> FloatArray:
        """Return the value in each `cell` before `step`, arrays of equal shape.

        A missing entry of a dict has its first value. A cell of another environment is clipped.
        """
        value: FloatArray = self._initial.take(cell, mode="clip")
        if len(self._cell):
            place = np.searchsorted(self._key, cell * self._span + step) - 1
            known = self._cell.take(place, mode="clip") == cell
            value = np.where(known & (place >= 0), self._after.take(place, mode="clip"), value)
        return value


class _PairHistory(_TableHistory):
    """Two tables. `table`, `[N]`, is the one of each step from `first` on. Cells of the second count from
    `cells`.
    """

    def __init__(
        self, initial: FloatArray, changes: ChangeColumns, span: int, table: IntArray, first: int
    ) -> None:
        super().__init__(initial, changes, span)
        self._cells, self._table, self._first = len(initial) // 2, table, first

    def before(self, cell: IntArray, step: IntArray, *, of_other: bool = False) -> FloatArray:
        """Return values in each step's table, or the other one."""
        table = self._table.take(step - self._first, mode="clip")
        if of_other:
            table = 1 - table
        return super().before(cell.clip(0, self._cells - 1) + self._cells * table, step)


class Evidence:
    """The N steps since the table was found, oldest first, with the numbers in the code.

    `reward_before` is the reward of the program's previous step (0 at first), `next_action` and
    `previous_cell` are those in the episode (−1 if none). `initial`, `[S·A]`, is the table at the first step.
    If two tables change in turn, `table`, `[N]`, is the one that each step changed.
    """

    def __init__(
        self, recording: Recording, numbers: Mapping[str, float] | None = None, dtype: str = ""
    ) -> None:
        if recording.initial is None:
            raise ValueError("no table was found")
        self.recording, self.numbers, self.dtype = recording, numbers or {}, dtype
        self.actions = recording.actions
        steps = recording.steps
        self.is_pair = recording.initial_pair is not None
        found_at = recording.paired_at if self.is_pair else recording.found_at
        begin = max(found_at - recording.first, 0)
        self.number: IntArray = np.arange(begin, len(steps.state)) + recording.first
        cut = slice(begin, None)
        self.state, self.action = steps.state[cut], steps.action[cut]
        self.reward, self.next_state = steps.reward[cut], steps.next_state[cut]
        self.terminated, self.truncated = steps.terminated[cut], steps.truncated[cut]
        self.ends: BoolArray = self.terminated | self.truncated
        self.episode, self.episode_step = steps.episode[cut], steps.episode_step[cut]
        self.environment = steps.environment[cut]
        self.cell: IntArray = self.state * self.actions + self.action
        self.reward_before = np.concatenate(([0.0], steps.reward))[begin:-1]
        self.next_action, self.previous_cell = self._neighbours()
        first = int(self.number[0]) if len(self) else 0
        self.initial, self.changes = _settled(recording, self.cell, first)
        self.table: IntArray = np.zeros(len(self), np.int64)
        self.history = _TableHistory(self.initial, self.changes, recording.count + 2)
        if self.is_pair:
            self._divide(first)

    def __len__(self) -> int:
        return len(self.number)

    @property
    def states(self) -> int:
        """Number of rows of the table."""
        return len(self.initial) // self.actions

    def _divide(self, first: int) -> None:
        cells, changes = len(self.initial) // 2, self.changes
        at = (changes.step - first).clip(0, max(len(self) - 1, 0))
        if len(self):
            self.table[at] = changes.cell // cells
        self.history = _PairHistory(self.initial, changes, self.recording.count + 2, self.table, first)
        self.initial, self.changes = self.initial[:cells], changes._replace(cell=changes.cell % cells)

    def _neighbours(self) -> tuple[IntArray, IntArray]:
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
        if not len(self):
            return np.full(len(self.changes.step), -1)
        place = self.changes.step - self.number[0]
        at: IntArray = np.where((place >= 0) & (place < len(self)), place, -1)
        return at

    @property
    def has_next(self) -> BoolArray:
        """Steps with a known next action, `[N]`."""
        has_next: BoolArray = self.next_action != NO_ACTION
        return has_next

    @cached_property
    def runs_away_at(self) -> float:
        """First step with too large a number, or infinity."""
        changes = self.recording.changes
        large = np.abs(changes.after) >= _TOO_LARGE
        return float(changes.step[large].min()) if large.any() else np.inf

    @cached_property
    def changes_of(self) -> IntArray:
        """Changed cells of each step, `[N]`."""
        counted: IntArray = np.bincount(self._at[self._at >= 0], minlength=len(self))
        return counted

    @property
    def inner(self) -> BoolArray:
        """Steps within episodes with one change, `[N]`."""
        inner: BoolArray = (self.changes_of == 1) & ~self.ends
        return inner

    @cached_property
    def only_change(self) -> tuple[IntArray, FloatArray, FloatArray]:
        """Cell, old and new value of single changes, else −1, 0, 0."""
        cell: IntArray = np.full(len(self), -1)
        before, after = np.zeros(len(self)), np.zeros(len(self))
        if len(self):
            single = (self.changes_of[self._at] == 1) & (self._at >= 0)
            at = self._at[single]
            cell[at] = self.changes.cell[single]
            before[at] = self.changes.before[single]
            after[at] = self.changes.after[single]
        return cell, before, after

    @property
    def stays(self) -> BoolArray:
        """Steps without a change of their table, `[N]`. It is unknown for two."""
        stays: BoolArray = (self.changes_of == 0) & (not self.is_pair)
        return stays

    @cached_property
    def draws_table(self) -> bool:
        """True if both tables change in the same cells, by a seemingly random choice."""
        at = np.flatnonzero(self.changes_of == 1)
        cell, table, episode = self.cell[at], self.table[at], self.episode[at]
        turns = (np.diff(table) != 0)[episode[1:] == episode[:-1]]
        few = min(int(turns.sum()), int((~turns).sum()))
        alike = np.intersect1d(cell[table == 0], cell[table == 1])
        return len(alike) >= _FEWEST_ALIKE and few * _TURNS >= len(turns) > 0

    @cached_property
    def learns(self) -> BoolArray:
        """Steps of episodes with changes, `[N]`. Others may be evaluations."""
        if not len(self):
            return np.empty(0, np.bool_)
        first = int(self.episode.min())
        changed = np.zeros(int(self.episode.max()) - first + 1, np.bool_)
        changed[self.episode[self.changes_of > 0] - first] = True
        result: BoolArray = changed[self.episode - first]
        return result

    @cached_property
    def visits(self) -> tuple[IntArray, IntArray]:
        """Visits of each cell so far, `[N]`: in all episodes, and in those with changes."""
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
        """Relative precision of the table."""
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
        """True if all written numbers are whole."""
        return bool(np.array_equal(self.changes.after, np.rint(self.changes.after)))

    @cached_property
    def surely_ended(self) -> BoolArray:
        """Terminal steps, `[N]`. If the program's own limit may end episodes, only those into a state that is
        never left.
        """
        if not self.recording.has_own_ends:
            return self.terminated
        ended: BoolArray = self.terminated & ~np.isin(self.next_state, self.recording.steps.state)
        return ended

    def rows(self, state: IntArray, at: IntArray) -> FloatArray:
        """Return the rows of `state`, `[n]`, before the steps `at`, `[n]`, as `[n, A]`."""
        return self.history.before(*self._cells_of(state, at))

    def _cells_of(self, state: IntArray, at: IntArray) -> tuple[IntArray, IntArray]:
        cells = state[:, None] * self.actions + np.arange(self.actions)
        return cells, np.broadcast_to(self.number[at][:, None], cells.shape)

    def column_maxima(self, action: IntArray, at: IntArray) -> FloatArray:
        """Return the maximum over states for `action`, `[n]`, before the steps `at`, `[n]`."""
        cells = action[:, None] + self.actions * np.arange(self.states)
        steps = np.broadcast_to(self.number[at][:, None], cells.shape)
        maxima: FloatArray = self.history.before(cells, steps).max(1, initial=-np.inf)
        return maxima

    def mean_rows(self, state: IntArray, at: IntArray) -> FloatArray:
        """Return the rows of the mean of two tables."""
        rows = self.rows(state, at)
        return (rows + self.other_rows(state, at)) / 2 if self.is_pair else rows

    def other_rows(self, state: IntArray, at: IntArray) -> FloatArray:
        """Return the rows of the other one of two tables."""
        assert isinstance(self.history, _PairHistory)
        return self.history.before(*self._cells_of(state, at), of_other=True)


def _settled(recording: Recording, taken: IntArray, first: int) -> tuple[FloatArray, ChangeColumns]:
    """Fill missing entries.

    A dict makes rows on access, so an entry gets the most frequent initial value, its first value (random
    rows), or 0.
    """
    assert recording.initial is not None
    initial, changes, cells = recording.initial, recording.changes, len(recording.initial)
    if recording.initial_pair is not None:
        initial, changes = recording.initial_pair, recording.changes_of_pair
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
            looked_up = taken.take(step - first, mode="clip") != changes.cell[made] % cells
            began = np.where(looked_up, after, 0.0)
            initial, before = initial.copy(), before.copy()
            initial[changes.cell[made[::-1]]] = began[::-1]  # the first of several counts
            before[made] = began
    moved = before != now
    settled = ChangeColumns(changes.step, changes.cell, before, now)
    if not moved.all():
        settled = ChangeColumns._make(column[moved] for column in settled)
    return np.nan_to_num(initial), settled
