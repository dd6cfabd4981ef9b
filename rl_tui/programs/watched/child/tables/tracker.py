"""Following a table that may be assigned again."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from types import FrameType
from typing import Any, Final

import numpy as np

from rl_tui.programs.watched.child.environments.numbering import Numbering
from rl_tui.programs.watched.child.errors import with_callers
from rl_tui.programs.watched.child.tables.forms import Doubles, add_differences, differences_of
from rl_tui.programs.watched.child.tables.keyed_table import form_of
from rl_tui.programs.watched.child.tables.search import (
    EntryWay,
    TableCandidate,
    candidates,
    rank,
    twin_of,
)

_CLOSELY: Final = 500  # first comparisons, each of the whole table
_PATIENCE: Final = 20  # comparisons without a result, of the whole table and at ends of episodes
_GROWTH: Final = 1.05  # growth of the interval between whole comparisons without a result
_MOST_STEPS: Final = 256
_NUMBERS: Final = 3  # of each difference
_LOOK_AGAIN: Final = 1.1  # growth of the interval between searches for a lost table


class TableTracker:
    """Reports changes of the table `found`."""

    def __init__(self, found: TableCandidate, wanted: str | None) -> None:
        self.way, self.table, self.form = found.way, found.value, found.form
        self._wanted = wanted
        self._code = None if self.way.frame is None else self.way.frame.f_code
        self.is_another = False
        """True if another object was the table at the last call of `differences`."""
        self._calls, self._look_at = 0, 0
        self._since_whole, self._spacing, self._ends_left, self._quiet = 0, 1.0, _PATIENCE, 0
        self._peeked: dict[int, object] = {}
        self._changes_seen = 0
        self._visited: set[int] = set()  # since the last reset
        self.form.take(self.table)

    @property
    def numbering(self) -> Numbering:
        """States and actions of the table."""
        return self.form.numbering

    def differences(
        self, frame: FrameType | None, states: Iterable[int], *, at_reset: bool = False
    ) -> list[float]:
        """Return cell, old and new value of each change since the last call.

        Rows of the last steps, `states`, are always compared, and at a reset those of the whole episode.
        `frame` is None at the end of the program.
        """
        self._calls += 1
        way = self.way
        table = way.read() if way.frame is None else None  # usually a module variable, the fast case
        if table is not self.table:
            table = self._read(frame)
        self.is_another = table is not self.table
        if self.is_another:
            return self._bind(table)
        form = self.form
        if form.is_compared_whole:
            return form.differences(table, states)
        self._visited.update(states)
        if at_reset:  # learning at the end of an episode changes rows of all its states
            states, self._visited = self._visited, set()
        found = form.differences(table, states)
        self._since_whole += 1
        if self._since_whole >= self._spacing or frame is None or (at_reset and self._ends_left > 0):
            outside = form.all_differences(table)
            self._plan_next(bool(outside), at_reset)
            found += outside
        return found

    def changes_seen(self, states: Iterable[int]) -> int:
        """Return how often a row of `states` has changed."""
        table = self.way.read()
        if type(table) is not type(self.table):
            table = self.table
        peek, before = self.form.peek, self._peeked
        now = self._peeked = {state: peek(table, state) for state in states}
        for state, row in now.items():  # rows not compared last time may have changed at any time
            if before.get(state, row) != row and before[state] is not None:
                self._changes_seen += 1
        return self._changes_seen

    def rows_are_shared(self) -> bool:
        """Return True if rows are the same object."""
        return self.form.rows_are_shared(self.table)

    def row(self, state: int) -> Sequence[float]:
        """Return the row as last reported."""
        return self.form.row(state)

    def _plan_next(self, was_outside: bool, at_reset: bool) -> None:
        self._since_whole = 0
        if was_outside and not at_reset:
            self._spacing, self._quiet = 1.0, 0
        elif self._calls > _CLOSELY:
            self._quiet += 1
        if self._quiet > _PATIENCE:
            self._spacing = min(self._spacing * _GROWTH, _MOST_STEPS)
        if at_reset:
            self._ends_left = _PATIENCE if was_outside else self._ends_left - 1

    def _bind(self, table: Any) -> list[float]:
        form = form_of(table, self.numbering)
        if form is None:
            return []
        self.table = table
        if type(form) is type(self.form) and form.name == self.form.name and form.name != "array":
            return self.form.all_differences(table)
        before, self.form = self.form.values(), form
        form.take(table)
        return differences_of(before, form.values())

    def _read(self, frame: FrameType | None) -> Any:
        if self.way.frame is not None and not self._is_running(frame):
            self._follow(frame)
        now = self.way.read()
        if now is self.table or form_of(now, self.numbering) is not None:
            return now
        self._search(frame)
        now = self.way.read()
        return self.table if form_of(now, self.numbering) is None else now

    def _is_running(self, frame: FrameType | None) -> bool:
        mine = self.way.frame
        while frame is not None:
            if frame is mine:
                return True
            frame = frame.f_back
        return False

    def _follow(self, frame: FrameType | None) -> None:
        for above in with_callers(frame):
            if above.f_code is self._code:
                way = replace(self.way, frame=above, scope=above.f_locals)
                if form_of(way.read(), self.numbering) is not None:
                    self.way = way
                    return
        self._search(frame)

    def _search(self, frame: FrameType | None) -> None:
        """Search again, less and less often. The old table is kept until another is found."""
        if frame is None or self._calls < self._look_at:
            return
        found = candidates(frame, self.numbering, self._wanted)
        same = [each for each in found if each.value is self.table]
        if same or found:
            best = (same or found)[0]
            self.way = best.way
            self._code = None if best.way.frame is None else best.way.frame.f_code
            self._look_at = 0
        else:
            self._look_at = int(self._calls * _LOOK_AGAIN) + 1


# Two tables that change in turn


_TURNS: Final = 10  # changes of the other table than before, in the same episode, until both count as one
_MOST_OFTEN: Final = 3  # times as often the same table as the other one, or the reverse
_FEWEST_ALIKE: Final = 3  # cells that changed in both tables


class _PairTracker(TableTracker):
    """Follows a table with its `twin`.

    As soon as they change in turn, as in Double Q-learning, their mean is reported instead of the first.

    Args:
        found: The first table.
        twin: The other one.
        on_pair: Called with the name of the twin, and both tables, `[2·S·A]`.
        on_changes: Called with changes. Cells count from S·A in the first table, from 2·S·A in the other.
    """

    def __init__(
        self,
        found: TableCandidate,
        twin: TableCandidate,
        on_pair: Callable[[str, Doubles], None],
        on_changes: Callable[[list[float]], None],
    ) -> None:
        super().__init__(found, found.way.name())
        self._twin = TableTracker(twin, twin.way.name())
        self._on_pair, self._on_changes = on_pair, on_changes
        self._values: tuple[list[float], list[float]] | None = None
        self._turn: int | None = None  # the table that changed last in this episode
        self._turns = self._same = self._both = 0
        self._cells: tuple[set[float], set[float]] = (set(), set())  # changed in each table

    def differences(
        self, frame: FrameType | None, states: Iterable[int], *, at_reset: bool = False
    ) -> list[float]:
        states = tuple(states)
        found = super().differences(frame, states, at_reset=at_reset)
        others = self._twin.differences(frame, states, at_reset=at_reset)
        if self._values is not None:
            self.is_another = self.is_another or self._twin.is_another
            return self._of_mean(found, 0) + self._of_mean(others, 1)
        self._count(_moved(found), _moved(others))
        if at_reset:
            self._turn = None
        return found + self._begin() if self._is_pair() else found

    def changes_seen(self, states: Iterable[int]) -> int:
        states = tuple(states)
        return super().changes_seen(states) + self._twin.changes_seen(states)

    def rows_are_shared(self) -> bool:
        return super().rows_are_shared() or self._twin.rows_are_shared()

    def row(self, state: int) -> Sequence[float]:
        if self._values is None:
            return super().row(state)
        begin = state * self.form.actions
        return [self._mean(cell) for cell in range(begin, begin + self.form.actions)]

    def _count(self, first: set[float], other: set[float]) -> None:
        if first and other:
            self._both += 1
        elif first or other:
            turn = int(bool(other))
            self._cells[turn].update(first or other)
            self._turns += self._turn == 1 - turn
            self._same += self._turn == turn
            self._turn = turn

    def _is_pair(self) -> bool:
        few, many = sorted((self._turns, self._same))
        is_drawn = self._turns >= _TURNS and few * _MOST_OFTEN >= many and self._both * _TURNS <= few
        return is_drawn and len(self._cells[0] & self._cells[1]) >= _FEWEST_ALIKE

    def _begin(self) -> list[float]:
        both = self.form.values(), self._twin.form.values()
        self._values = both[0].tolist(), both[1].tolist()
        self.is_another = True
        self._on_pair(self._twin.way.name(), np.concatenate(both))
        found: list[float] = []
        add_differences(0, ((before, self._mean(cell)) for cell, before in enumerate(self._values[0])), found)
        return found

    def _of_mean(self, found: list[float], place: int) -> list[float]:
        assert self._values is not None
        values = self._values[place]
        mean: list[float] = []
        for at in range(0, len(found), _NUMBERS):
            cell = int(found[at])
            before = self._mean(cell)
            values[cell] = found[at + 2]
            add_differences(cell, [(before, self._mean(cell))], mean)
        if found:
            offset = (1 + place) * len(values)
            self._on_changes([x + offset * (at % _NUMBERS == 0) for at, x in enumerate(found)])
        return mean

    def _mean(self, cell: int) -> float:
        assert self._values is not None
        first, other = (values[cell] for values in self._values)
        if first != first:
            return other
        return first if other != other else (first + other) / 2


def _moved(found: Sequence[float]) -> set[float]:
    """Return the cells of differences that change an entry, and do not only make it."""
    cells = zip(found[::_NUMBERS], found[1::_NUMBERS], strict=True)
    return {cell for cell, before in cells if before == before}


def tracker_of(
    found: Sequence[TableCandidate],
    wanted: str | None,
    on_pair: Callable[[str, Doubles], None],
    on_changes: Callable[[list[float]], None],
) -> TableTracker:
    """Return the tracker of the first candidate, or of an equal one with a twin, unless the user named it."""
    first = found[0]
    if wanted is None or (isinstance(first.way, EntryWay) and wanted != first.way.name()):
        likely = rank(first.way.names[-1], first.value)
        for each in found:
            twin = twin_of(each) if rank(each.way.names[-1], each.value) == likely else None
            if twin is not None:
                return _PairTracker(each, twin, on_pair, on_changes)
    return TableTracker(first, wanted)
