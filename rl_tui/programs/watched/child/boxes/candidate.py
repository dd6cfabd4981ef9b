"""A table that may be the program's: its index has each step's action."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass, field
from math import prod
from types import FrameType
from typing import Any, Final

import numpy as np

from rl_tui.programs.watched.child.boxes.sites import Index, IndexSite, Sites
from rl_tui.programs.watched.child.environments.making import Making
from rl_tui.programs.watched.child.tables.forms import Doubles, HeldTable
from rl_tui.programs.watched.child.tables.keyed_table import form_of, sizes_of
from rl_tui.programs.watched.child.worlds.met import Key, MetNumbering, UnfitError

_ENOUGH: Final = 20
_MANY: Final = 500
ENOUGH_MOVED: Final = 3
"""Steps to another state among them, because an index of the state itself is right at the others."""
MOST_HELD: Final = 5_000
"""Steps without a table, after which the oldest are not reported any more."""
_MOST_IN_ORDER: Final = 2_000
_MOST_WRONG: Final = 0.02
"""Most assignments with another action, for each with that of its step."""
_UNKNOWN: Final = "unknown"
"""Name of a state that no index shows."""
ReadPlace = tuple[int, int]
"""A site, and an index that its function reads."""


@dataclass
class Seen:
    """Changes of a table between a step and the next call: flat lists of cell, old and new value."""

    key: Key | None = None
    action: int = -1
    """The action in the last index."""
    reads: dict[ReadPlace, int] = field(default_factory=dict)
    """States that were read beside it."""
    before: list[float] = field(default_factory=list)
    """Differences that were there before the first assignment."""
    changes: list[float] = field(default_factory=list)


class LateReports:
    """Reports steps that assignments to a table show, each once the next one is known."""

    _lost = "the table is no longer followed"

    def __init__(self, making: Making) -> None:
        self._making, self._recorder, self._note = making, making.recorder, making.note
        self._table: IndexedTable | None = None
        self._pending: deque[Any] = deque()
        self._open: tuple[int, IndexedTable, set[int], Seen] | None = None
        """The assignment that the program is making: its site, table, and states with what they showed."""
        self.number, self._episode = -1, -1
        self.is_over = False
        """True if no further step is reported."""

    def wants(self, index: Index) -> bool:
        """Return True if this table may be followed."""
        return self._recorder.wanted in (None, index.name, index.name.split(".")[-1])

    def after_put(self, site: int, sites: Sites, frame: FrameType) -> None:
        """Compare the rows of an assignment."""
        del sites, frame
        if self._open is not None and self._open[0] == site:
            _, table, states, seen = self._open
            if table.form is not None:
                seen.changes += table.form.differences(table.table, states)
        self._open = None

    def _follow(self, name: str, table: IndexedTable, others: Mapping[str, str], time_limit: int = 0) -> None:
        assert table.form is not None
        assert table.initial is not None
        self._table = table
        self.number = self._making.announce_own(name, table.numbering, time_limit)
        self._making.tell_names(self.number, table.numbering)
        self._recorder.follow(table.name, table.form, table.table, table.initial, others)

    def _report_until(self, left: int, frame: FrameType | None, method: str = "step") -> None:
        """Report all but `left` steps, each once permitted."""
        assert self._table is not None
        numbering = self._table.numbering
        self._recorder.before(frame, numbering, method)
        while len(self._pending) > left and not self.is_over:
            self._report(self._pending.popleft())
            self._recorder.before(frame, numbering, method)

    def _report(self, step: Any) -> None:
        raise NotImplementedError

    def _tell(
        self,
        states: tuple[int | None, int | None],
        step: tuple[int, float, int, int],
        seen: Seen,
        *,
        is_end: bool,
    ) -> None:
        """Report a step between two `states`, None if unknown, by its action, reward, flags and place."""
        assert self._table is not None
        numbering, (action, reward, flags, place) = self._table.numbering, step
        try:
            state, after = (numbering.state(_UNKNOWN) if each is None else each for each in states)
        except UnfitError as why:
            self._note(f"{self._lost}: {why}")
            self.is_over = True
            return
        if place == 0 or self._episode < 0:
            self._episode = self._recorder.begin_episode()
        told = (self.number, state, action, reward, after, flags, self._episode, place)
        self._recorder.after_late(told, numbering, seen.before, seen.changes, is_end=is_end)


class IndexedTable:
    """A table of `actions` actions, and the assignments to it."""

    def __init__(self, name: str, actions: int) -> None:
        self.name = name
        self.numbering = MetNumbering((), actions, has_fractions=True)
        self.form: HeldTable | None = None
        self.table: Any = None
        self.initial: Doubles | None = None
        self._lines: dict[tuple[str, int], int] = {}
        self.right = self.wrong = 0
        """Assignments with the action of the step, and others."""
        self._votes: dict[ReadPlace, list[int]] = {}
        """Counts of each index: right, right after a step to another state, and wrong."""

    def begin(self) -> None:
        """Take the table of now as the initial one."""
        if not self.is_hopeless:
            self.right = self.wrong = 0
        self.initial = None if self.form is None else self.form.values()

    @property
    def lines(self) -> list[tuple[str, int, int]]:
        """File, line and number of assignments."""
        return [(*place, count) for place, count in self._lines.items()]

    @property
    def is_usable(self) -> bool:
        """True if enough assignments had their step's action."""
        return self.right >= _ENOUGH and self.wrong <= self.right * _MOST_WRONG

    @property
    def is_hopeless(self) -> bool:
        """True if many assignments had another action."""
        return self.wrong > max(_MANY, self.right * _MOST_WRONG)

    def look(
        self, site: IndexSite, number: int, frame: FrameType, action: int | None, seen: Seen
    ) -> set[int] | None:
        """Return the states of an assignment, or None for others. Without an `action`, the index shows it."""
        keys, table = site.index.keys(frame), site.index.table(frame)
        if keys is None or len(keys) < 2 or (action is not None and type(keys[-1]) is not int):
            return None
        key, name = keys[0] if len(keys) == 2 else keys[:-1], keys[-1]
        if type(name) is int and not 0 <= name < self.numbering.actions:
            return None
        if self.form is None:
            self._number_in_order(table, len(keys))
        try:
            state = self.numbering.state(key)
            seen.action = self.numbering.action(name)
        except UnfitError:
            return None
        if not self._take(table):
            return None
        assert self.form is not None
        is_right = action in (None, seen.action) and seen.key in (None, key)
        self.right, self.wrong = self.right + is_right, self.wrong + (not is_right)
        if is_right:
            seen.key = key
            place = frame.f_code.co_filename, site.line
            self._lines[place] = self._lines.get(place, 0) + 1
        states = {state}
        for at, index in enumerate(site.reads):
            read = self._state_read(index, frame, len(keys) - 1)
            if read is not None:
                states.add(read)
                if is_right:
                    seen.reads[number, at] = read
        found = self.form.differences(table, states)
        if seen.changes:
            seen.changes += found
        else:
            seen.before += found
        return states

    def judge(self, seen: Seen, state: int, next_state: int) -> None:
        """Learn from a known step which index reads the next state."""
        for place, read in seen.reads.items():
            votes = self._votes.setdefault(place, [0, 0, 0])
            votes[0] += read == next_state
            votes[1] += read == next_state != state
            votes[2] += read != next_state

    def next_state(self, seen: Seen) -> int | None:
        """Return the next state by an index that was always right, if any."""
        votes = {place: self._votes.get(place, (0, 0, 0)) for place in seen.reads}
        sure = [
            place
            for place, (right, moved, wrong) in votes.items()
            if right >= _ENOUGH and moved >= ENOUGH_MOVED and not wrong
        ]
        return seen.reads[max(sure, key=lambda place: votes[place])] if sure else None

    def _number_in_order(self, table: Any, parts: int) -> None:
        sizes = sizes_of(table)
        count = prod(sizes[:-1])
        if len(sizes) == parts and sizes[-1] == self.numbering.actions and count <= _MOST_IN_ORDER:
            places = np.ndindex(*sizes[:-1])
            states = [each[0] if parts == 2 else each for each in places]
            self.numbering = MetNumbering(states, sizes[-1], most=count + 1)  # one more for unknown states

    def _take(self, table: Any) -> bool:
        """Return False if `table` has no numbers for the states met so far."""
        if self.form is None:
            self.form = form_of(table, self.numbering)
            if self.form is not None:
                self.form.take(table)
                self.initial = self.form.values()
        self.table = table
        return self.form is not None

    def _state_read(self, index: Index, frame: FrameType, parts: int) -> int | None:
        keys = index.keys(frame)
        if keys is None or len(keys) not in (parts, parts + 1):
            return None
        try:
            return self.numbering.state(keys[0] if parts == 1 else keys[:parts])
        except UnfitError:
            return None
