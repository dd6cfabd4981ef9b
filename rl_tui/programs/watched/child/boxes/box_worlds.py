"""Steps whose states are known by the table's index, each reported one step late."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise
from time import monotonic
from types import FrameType
from typing import Any, Final

import gymnasium

from rl_tui.programs.watched.child.boxes.candidate import MOST_HELD, IndexedTable, LateReports, Seen
from rl_tui.programs.watched.child.boxes.sites import Sites
from rl_tui.programs.watched.child.boxes.table_steps import TableSteps
from rl_tui.programs.watched.child.environments.making import Making, id_of
from rl_tui.programs.watched.child.environments.numbering import Numbering
from rl_tui.programs.watched.child.environments.watched_env import StepReports
from rl_tui.programs.watched.child.tables.search import rank
from rl_tui.programs.watched.child.worlds.first_steps import FEW_STEPS, step_of
from rl_tui.programs.watched.child.worlds.met import MOST_STATES, UnfitError
from rl_tui.programs.watched.messages import MessageKind

_PATIENCE: Final = 5.0  # seconds without a table before a message
_UNREAD: Final = (
    "{}: rl-tui reads the state from the index of your table, but your program has not written to a "
    "table with a readable index yet"
)
_OF_OTHERS: Final = (
    "{}: rl-tui reads the state from the index of your table. {} is not used, because each step changes "
    "actions that were not taken"
)


@dataclass
class _Pending:
    action: int
    reward: float
    flags: int
    place: int
    seen: dict[str, Seen] = field(default_factory=dict)
    """What each table showed after it."""


class BoxReports(LateReports, StepReports):
    """Reports the steps of an environment with `actions`, once a table is found."""

    def __init__(self, env: gymnasium.Env[Any, Any], making: Making) -> None:
        actions = int(env.action_space.n)
        StepReports.__init__(self, -1, Numbering((MOST_STATES,), (0,), False, actions, 0), making.recorder)
        LateReports.__init__(self, making)
        self._name, self._lost = id_of(env), f"{id_of(env)} is no longer watched"
        self._time_limit = (0 if env.spec is None else env.spec.max_episode_steps) or 0
        self._candidates: dict[str, IndexedTable] = {}
        self._began = monotonic()
        self._next_state: int | None = None
        """State after the last reported step."""

    def step(self, frame: Any, take: Callable[[Any], Any], action: Any) -> Any:
        """Take a step, once permitted, and keep it."""
        self._before(frame, "step")
        result = self._call(take, action)
        step = step_of(result)
        try:
            number = self.numbering.action(action)
        except (TypeError, ValueError):
            step = None
        if step is None:
            self._leave_out()
        elif not self.is_over:
            self._pending.append(_Pending(number, step.reward, step.flags, self._place))
            self._place += 1
        return result

    def reset(self, frame: Any, begin: Callable[[], Any]) -> Any:
        """Begin an episode, once permitted."""
        self._before(frame, "reset")
        self._recorder.resets += self._table is not None
        self._place = 0
        return self._call(begin)

    def before_put(self, site: int, sites: Sites, frame: FrameType) -> None:
        """Read the index of an assignment beforehand."""
        self._open = None
        if self.is_over or not self._pending:
            return
        index = sites[site].index
        if not self.wants(index):
            return
        candidate = self._candidates.get(index.name)
        if candidate is None:
            if self._table is not None:
                return
            candidate = self._candidates[index.name] = IndexedTable(index.name, self.numbering.actions)
        if candidate.is_hopeless:
            return
        step = self._pending[-1]
        seen = step.seen.setdefault(index.name, Seen())
        states = candidate.look(sites[site], site, frame, step.action, seen)
        if states is not None:
            self._open = site, candidate, states, seen

    def finish(self) -> None:
        """Report the last steps."""
        if self.is_over or (self._table is None and self._recorder.count):
            return
        if self._table is None:
            self._choose()
        if self._table is not None:
            self._report_until(0, None, "reset")
        else:
            self._note(self._reason())
        self.is_over = True

    def _before(self, frame: Any, method: str) -> None:
        self._open = None
        if self.is_over:
            return
        if self._table is None and self._recorder.count:  # a world around this one reports
            self._drop()
        elif self._table is None and len(self._pending) >= FEW_STEPS:
            self._choose()
            if self._table is None:
                self._wait_for_table()
        if self._table is not None:
            if len(self._pending) > 1:
                self._judge(self._pending[-2], self._pending[-1])
            self._report_until(0 if method == "reset" else 1, frame, method)

    def _reason(self) -> str:
        others = [each.name for each in self._candidates.values() if each.wrong > each.right]
        return (_OF_OTHERS if others else _UNREAD).format(self._name, *others)

    def _wait_for_table(self) -> None:
        are_too_many = len(self._pending) >= MOST_HELD
        if are_too_many or monotonic() > self._began + _PATIENCE:
            self._note(self._reason())
        if are_too_many:  # the search begins anew
            self._pending.clear()
            for each in self._candidates.values():
                each.begin()

    def _drop(self) -> None:
        self.is_over = True
        self._pending.clear()

    def _choose(self) -> None:
        usable = [each for each in self._candidates.values() if each.is_usable]
        if not usable:
            return
        usable.sort(key=lambda each: (rank(each.name.split(".")[-1], each.table), -each.right))
        self._candidates = {each.name: each for each in usable}
        table = usable[0]
        others = {each.name: each.form.name for each in usable[1:] if each.form is not None}
        self._follow(self._name, table, others, self._time_limit)
        self._recorder.channel.message(MessageKind.LINES, lines=table.lines)
        for step, after in pairwise(list(self._pending)[:-1]):
            self._judge(step, after)

    def _judge(self, step: _Pending, after: _Pending) -> None:
        table = self._table
        assert table is not None
        state, next_state = self._state(step), self._state(after)
        if after.place and state is not None and next_state is not None:
            table.judge(step.seen.get(table.name, Seen()), state, next_state)

    def _state(self, step: _Pending) -> int | None:
        assert self._table is not None
        keys = [step.seen[name].key for name in self._candidates if name in step.seen]
        known = [each for each in keys if each is not None]
        try:
            return self._table.numbering.state(known[0]) if known else None
        except UnfitError:
            return None

    def _report(self, step: _Pending) -> None:
        assert self._table is not None
        seen = step.seen.get(self._table.name, Seen())
        after = self._pending[0] if self._pending and self._pending[0].place else None
        if step.place == 0:
            self._next_state = None
        state = self._state(step)
        if state is None:
            state = self._next_state
        self._next_state = None if after is None else self._state(after)
        if self._next_state is None:
            self._next_state = self._table.next_state(seen)
        told = step.action, step.reward, step.flags, step.place
        self._tell((state, self._next_state), told, seen, is_end=after is None)


class BoxWorlds:
    """Watches the first environment whose observations have fractions, and others with its name."""

    def __init__(self, making: Making, has_steps: Callable[[], bool]) -> None:
        self._making = making
        self._name = ""
        self._reports: BoxReports | None = None
        self.sites = Sites()
        self.table_steps = TableSteps(making, self._has_reports, has_steps)

    def install(self) -> None:
        """Watch environments from now on."""
        self._making.without_states = self._reports_of
        self.sites.call(self._before_put, self._after_put)

    def finish(self) -> None:
        """Report the last steps."""
        (self._reports or self.table_steps).finish()

    def _has_reports(self) -> bool:
        return self._reports is not None or self._making.recorder.count > 0

    def _reports_of(self, env: gymnasium.Env[Any, Any]) -> BoxReports | None:
        name, actions = id_of(env), env.action_space
        is_free = self._reports is None or not (self._reports.is_used or self._name == name)
        if is_free and isinstance(actions, gymnasium.spaces.Discrete) and actions.start == 0:
            self.sites.begin()
            self._name = name
            self._reports = BoxReports(env, self._making)
        return self._reports if self._name == name else None

    def _before_put(self, site: int) -> None:
        (self._reports or self.table_steps).before_put(site, self.sites, sys._getframe(1))

    def _after_put(self, site: int) -> None:
        (self._reports or self.table_steps).after_put(site, self.sites, sys._getframe(1))
