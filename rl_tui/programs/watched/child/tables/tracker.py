"""Following the table of a program, which may be assigned again."""

from __future__ import annotations

from collections.abc import Iterable
from types import FrameType
from typing import Any, Final

from rl_tui.programs.watched.child.environments.numbering import Numbering
from rl_tui.programs.watched.child.tables.recognition import form_of
from rl_tui.programs.watched.child.tables.search import MISSING, TableCandidate, Way, candidates

_CLOSELY: Final = 500  # first comparisons, each of the whole table
_PATIENCE: Final = 20  # comparisons without a result, of the whole table and at ends of episodes
_GROWTH: Final = 1.05  # growth of the interval between whole comparisons without a result
_MOST_STEPS: Final = 256
_NUMBERS: Final = 3  # of each difference
_LOOK_AGAIN: Final = 1.1  # growth of the interval between searches for a lost table


class TableTracker:
    """Reports changes of the table `found`. `wanted` is the name or path given by the user."""

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
        """Return all changes since the last call: cell, old and new value of each. Rows of the last steps
        are always compared, and at a reset those of the whole episode.

        Args:
            frame: Frame that called `step` or `reset`, None at the end of the program.
            states: States of the last steps.
            at_reset: True for `reset`.
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
        """Return how often a row of `states` has changed between calls of this function."""
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
        """Return True if rows of the table are the same object."""
        return self.form.rows_are_shared(self.table)

    def _plan_next(self, was_outside: bool, at_reset: bool) -> None:
        """Compare the whole table more often if it changes elsewhere, else less often."""
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
        return self._bind_form(form, table)

    def _bind_form(self, form: Any, table: Any) -> list[float]:
        import numpy as np

        before = self.form.values()
        form.take(table)
        self.form = form
        after = form.values()
        cells = np.flatnonzero((before != after) & ~(np.isnan(before) & np.isnan(after)))
        found: list[float] = np.column_stack((cells, before[cells], after[cells])).ravel().tolist()
        return found

    def _read(self, frame: FrameType | None) -> Any:
        if self.way.frame is not None and not self._is_running(frame):
            self._follow(frame)
        now = self.way.read()
        if now is self.table:
            return now
        if now is MISSING or form_of(now, self.numbering) is None:
            self._search(frame)
            return self.table if self.way.read() is MISSING else self._fit(self.way.read())
        return now

    def _fit(self, value: Any) -> Any:
        return value if form_of(value, self.numbering) is not None else self.table

    def _is_running(self, frame: FrameType | None) -> bool:
        mine = self.way.frame
        while frame is not None:
            if frame is mine:
                return True
            frame = frame.f_back
        return False

    def _follow(self, frame: FrameType | None) -> None:
        """Find the table again after its function has ended: in the next call, or elsewhere."""
        above = frame
        while above is not None:
            if above.f_code is self._code:
                way = Way(above, above.f_locals, self.way.names)
                if self._fits(way):
                    self.way = way
                    return
            above = above.f_back
        self._search(frame)

    def _fits(self, way: Way) -> bool:
        return form_of(way.read(), self.numbering) is not None

    def _search(self, frame: FrameType | None) -> None:
        """Search for the table again, less and less often. The old one is kept until another is found."""
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
