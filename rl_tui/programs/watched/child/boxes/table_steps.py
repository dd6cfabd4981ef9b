"""Steps of a program whose world cannot be watched: assignments to its table."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from types import FrameType
from typing import Final

from rl_tui.programs.watched.child.boxes.candidate import (
    ENOUGH_MOVED,
    MOST_HELD,
    IndexedTable,
    LateReports,
    Seen,
)
from rl_tui.programs.watched.child.boxes.sites import IndexSite, Sites
from rl_tui.programs.watched.child.environments.making import Making
from rl_tui.programs.watched.child.tables.keyed_table import shape_of
from rl_tui.programs.watched.child.tables.search import rank
from rl_tui.programs.watched.child.worlds.first_steps import FEW_STEPS

_NAME: Final = "world of {}"
_CHOSEN: Final = "each assignment to {} counts as a step of the program"
_FEWEST_JOINED: Final = 0.5
"""Smallest share of steps after which the next assignment begins in their next state."""
_MANY_OTHERS: Final = 200
"""Assignments to another object with the same name, after which that is the table."""


@dataclass
class _Put:
    name: str
    function: int
    state: int
    reward: float
    seen: Seen
    reads: dict[int, int]
    """States that were read beside it, by their places in the function."""


class TableSteps(LateReports):
    """Reports assignments to a table as steps, once it is known which index is the next state."""

    def __init__(
        self, making: Making, has_reports: Callable[[], bool], has_steps: Callable[[], bool]
    ) -> None:
        super().__init__(making)
        self._has_reports, self._has_steps = has_reports, has_steps
        self._tables: dict[str, IndexedTable] = {}
        self._reads: dict[int, int] = {}
        """The place of the read next state, for each function."""
        self._place = self._others = 0

    def before_put(self, site: int, sites: Sites, frame: FrameType) -> None:
        """Read an assignment that is about to be made."""
        self._open = None
        at = sites[site]
        reward = None
        if at.has_action and not self.is_over:
            reward = 0.0 if at.is_called else at.reward(frame)
        if reward is None or not self.wants(at.index):
            return
        table = self._tables.get(at.index.name)
        if self._table is None:
            self.is_over = self._has_reports() or len(self._pending) >= MOST_HELD
            if self.is_over:
                return
            if len(self._pending) >= FEW_STEPS and not self._has_steps():
                self._choose(frame)
            table = table or self._table_at(sites, site, frame)
        if table is None or self._table not in (None, table) or self._is_of_another(table, at, frame):
            return
        seen = Seen()
        states = table.look(at, site, frame, None, seen)
        if states is None or seen.key is None:
            return
        reads = {place: state for (_, place), state in seen.reads.items()}
        put = _Put(table.name, id(at.reads), table.numbering.state(seen.key), reward, seen, reads)
        self._pending.append(put)
        if self._table is not None:
            self._report_until(1, frame)
        self._open = site, table, states, seen

    def after_put(self, site: int, sites: Sites, frame: FrameType) -> None:
        """Compare the rows of an assignment, and read the reward that it has called for."""
        is_open = self._open is not None and self._open[0] == site
        super().after_put(site, sites, frame)
        if is_open and sites[site].is_called:
            reward = sites[site].reward(frame)
            if reward is None:
                self._pending.pop()
            else:
                self._pending[-1].reward = reward

    def finish(self) -> None:
        """Report the last steps."""
        if self._table is None and not self._has_reports():
            self._choose(None)
        if self._table is not None and not self.is_over:
            self._report_until(0, None)

    def _is_of_another(self, table: IndexedTable, site: IndexSite, frame: FrameType) -> bool:
        is_same = table.table is None or site.index.table(frame) is table.table
        self._others = 0 if is_same or self._others >= _MANY_OTHERS else self._others + 1
        return self._others > 0

    def _table_at(self, sites: Sites, site: int, frame: FrameType) -> IndexedTable | None:
        index = sites[site].index
        keys, value = index.keys(frame), index.table(frame)
        if keys is None or len(keys) < 2:
            return None
        try:
            shape = shape_of(value, [keys[0] if len(keys) == 2 else keys[:-1]])
        except (LookupError, TypeError, ValueError, AttributeError):
            return None
        if shape is None:
            return None
        return self._tables.setdefault(index.name, IndexedTable(index.name, shape.actions))

    def take_over(self, frame: FrameType | None) -> bool:
        """Report in place of a world without a table. Return False without one here."""
        if self._table is None and not (self.is_over or self._has_reports()):
            self._choose(frame)
        return self._table is not None

    def _choose(self, frame: FrameType | None) -> None:
        tables = [each for each in self._tables.values() if each.form is not None]
        for table in sorted(tables, key=lambda each: rank(each.name.split(".")[-1], each.table)):
            puts = [each for each in self._pending if each.name == table.name]
            reads = _next_state_reads(puts)
            if reads:
                self._pending, self._reads = deque(puts), reads
                self._note(_CHOSEN.format(table.name))
                self._follow(_NAME.format(table.name), table, {})
                self._report_until(1, frame)
                return

    def _report(self, step: _Put) -> None:
        next_state = step.reads.get(self._reads.get(step.function, -1))
        is_end = not self._pending or self._pending[0].state != next_state
        told = step.seen.action, step.reward, 0, self._place
        self._tell((step.state, next_state), told, step.seen, is_end=is_end)
        self._place = 0 if is_end else self._place + 1


def _next_state_reads(puts: list[_Put]) -> dict[int, int]:
    votes: dict[int, Counter[int]] = {}
    moved: Counter[tuple[int, int]] = Counter()
    totals = Counter(each.function for each in puts[:-1])
    for put, after in pairwise(puts):
        for place, state in put.reads.items():
            if state == after.state:
                votes.setdefault(put.function, Counter())[place] += 1
                moved[put.function, place] += state != put.state
    best, has_one_state = {}, len({each.state for each in puts}) == 1
    for function, counted in votes.items():
        place = max(counted, key=lambda each: (moved[function, each], counted[each]))
        is_sure = counted[place] >= totals[function] * _FEWEST_JOINED
        if is_sure and (has_one_state or moved[function, place] >= ENOUGH_MOVED):
            best[function] = place
    return best
