"""The recorder of a program's steps and table changes."""

from __future__ import annotations

import math
import os
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from threading import get_ident
from types import CodeType, FrameType, FunctionType
from typing import Any, Final, NoReturn

import numpy as np

from rl_tui.programs.watched.child.channel import Channel, Gate
from rl_tui.programs.watched.child.environments.numbering import Numbering
from rl_tui.programs.watched.child.errors import is_users_file, users_place, with_callers
from rl_tui.programs.watched.child.line_trace import TRACED_AT_FIRST, LineTrace, Place
from rl_tui.programs.watched.child.tables.forms import Doubles, HeldTable
from rl_tui.programs.watched.child.tables.search import TableCandidate, attributes, candidates, turned_table
from rl_tui.programs.watched.child.tables.tracker import TableTracker, tracker_of
from rl_tui.programs.watched.messages import MessageKind

# Numbers in the code


_OF_THE_STEP: Final = ("r", "reward", "info")  # results of the environment, not of the code
_MOST: Final = 500
_MOST_OF_A_DICT: Final = 100
_DEEPEST_CODE: Final = 8


def numbers_in(frame: FrameType | None, scope: Mapping[str, Any]) -> dict[str, float]:
    """Return floats by name from user code above `frame`, and from `scope`.

    Attributes and entries are named `agent.gamma` or `config.gamma`, defaults of functions `train.gamma`, and
    constants by their text, such as `0.99`.
    """
    found: dict[str, float] = {}
    for names, code in _scopes(frame, scope):
        if code is not None:
            found.update({repr(each): each for each in _constants(code)})
        for name, value in list(names.items()):
            if not (name.startswith("_") or name in _OF_THE_STEP):
                for inner, each in _inside(name, value):
                    if (number := _number(each)) is not None:
                        found[inner] = number
        if len(found) >= _MOST:
            break
    return dict(list(found.items())[:_MOST])


def _scopes(
    frame: FrameType | None, scope: Mapping[str, Any]
) -> Iterator[tuple[Mapping[str, Any], CodeType | None]]:
    yield scope, None
    seen: set[int] = {id(scope)}
    for each in with_callers(frame):
        if is_users_file(each.f_code.co_filename):
            yield each.f_locals, each.f_code
            if id(each.f_globals) not in seen and each.f_locals is not each.f_globals:
                yield each.f_globals, None
            seen.add(id(each.f_globals))


def _inside(name: str, value: Any) -> Iterator[tuple[str, Any]]:
    yield name, value
    if type(value) is FunctionType:
        if is_users_file(value.__code__.co_filename):
            code, defaults = value.__code__, value.__defaults__ or ()
            last = code.co_varnames[code.co_argcount - len(defaults) : code.co_argcount]
            given = [*zip(last, defaults, strict=True), *(value.__kwdefaults__ or {}).items()]
            yield from ((f"{name}.{each}", default) for each, default in given)
            yield from ((repr(each), each) for each in _constants(code))
    elif type(value) is dict:
        if len(value) <= _MOST_OF_A_DICT:
            yield from ((f"{name}.{key}", each) for key, each in value.items() if type(key) is str)
    else:
        yield from ((f"{name}.{key}", each) for key, each in list(attributes(value).items()))


def _constants(code: CodeType, depth: int = 0) -> Iterator[float]:
    for each in code.co_consts:
        if type(each) is float:
            yield each
        elif isinstance(each, CodeType) and depth < _DEEPEST_CODE:
            yield from _constants(each, depth + 1)
        elif type(each) is tuple:
            yield from (part for part in each if type(part) is float)


def _number(value: Any) -> float | None:
    if type(value) is float or issubclass(type(value), np.floating):
        return float(value) if math.isfinite(value) else None
    return None


# Conditions to stop at


Row = Callable[[int], Sequence[float]]
"""Returns the current row of a state, NaN for missing entries."""
_CHANGE: Final = 3  # numbers: cell, before, after
Step = tuple[int, int, int, float, int, int, int, int]
"""A step in the form of the pipe."""


class _StopConditions:
    """Events to stop at, as in messages.py."""

    def __init__(self, said: Mapping[str, Any], actions: int) -> None:
        self._actions = actions
        self._states = frozenset(said.get("states", ()))
        self._cells = frozenset(said.get("cells", ()))
        self._reward = bool(said.get("reward"))
        self._ends_left = said.get("episode_ends")
        self._episode = said.get("episode")
        self._value = said.get("value")
        self._policy = bool(said.get("policy"))

    def met_by(self, step: Step, changes: Sequence[float], row: Row, *, is_end: bool) -> str | None:
        _, state, action, reward, next_state, _, episode, _ = step
        if next_state in self._states:
            return "states"
        if state * self._actions + action in self._cells:
            return "cells"
        if self._reward and reward != 0.0:
            return "reward"
        if self._ends_left is not None and is_end:
            self._ends_left -= 1
            if self._ends_left <= 0:
                return "episode_ends"
        if self._episode is not None and is_end and episode + 1 >= self._episode:
            return "episode"
        if self._value is not None and self._is_crossed(changes):
            return "value"
        return "policy" if self._policy and self._is_another_policy(changes, row) else None

    def _is_crossed(self, changes: Sequence[float]) -> bool:
        cell, threshold = self._value or (-1, 0.0)
        mine = [place for place in range(0, len(changes), _CHANGE) if changes[place] == cell]
        if not mine:
            return False
        before, after = _or_0(changes[mine[0] + 1]), _or_0(changes[mine[-1] + 2])
        return before != after and min(before, after) <= threshold <= max(before, after)

    def _is_another_policy(self, changes: Sequence[float], row: Row) -> bool:
        first_before: dict[int, float] = {}
        for place in range(0, len(changes), _CHANGE):
            first_before.setdefault(int(changes[place]), changes[place + 1])
        for state in {cell // self._actions for cell in first_before}:
            now = [_or_0(each) for each in row(state)]
            base = state * self._actions
            then = [_or_0(first_before.get(base + action, each)) for action, each in enumerate(now)]
            if _best(now) != _best(then):
                return True
        return False


def _or_0(number: float) -> float:
    return 0.0 if math.isnan(number) else number


def _best(numbers: Sequence[float]) -> list[int]:
    best = max(numbers)
    return [place for place, each in enumerate(numbers) if each == best]


# The recorder


_LOOKED_CLOSELY: Final = 200  # first steps, each with a search for the table
_THEN_EVERY: Final = 1.05  # growth of the interval between later searches
_MOST_TRACES: Final = 2  # times that lines are traced, while too few were found
_MOST_REBOUND: Final = 1_000  # messages about another object
_MANY_THREADS: Final = "several threads take steps, so rl-tui cannot match changes of the table with steps"
_FORKED: Final = (
    "a forked process takes steps, but its table is not visible here: take all steps in the main process"
)


class Recorder:
    """Sees every step. `most` limits them, and `wanted` is the user's name of the table."""

    def __init__(self, channel: Channel, gate: Gate, *, most: int | None, wanted: str | None) -> None:
        self.channel, self.gate = channel, gate
        self.count = 0
        self.resets = 0
        """Number of episodes begun, also those without a step."""
        self._most, self.wanted = most, wanted
        self._tracker: TableTracker | None = None
        self._late_form: HeldTable | None = None
        """Form of the table given to `follow`."""
        self._next_look = self._next_numbers = 0
        self._episodes = self._rebound = 0
        self._recent: tuple[int, ...] = (0,)
        self._last: Step | None = None  # until the next call, for events
        self._last_numbering: Numbering | None = None
        self._numbering: Numbering | None = None
        self._stop: _StopConditions | None = None
        self._met: str | None = None
        self._thread: int | None = None
        self._called: set[str] = set()
        self._is_shared = self._turned_is_noted = False
        self._traces_left = _MOST_TRACES
        self._trace = LineTrace(self._content, self._tell_lines)
        gate.on_asked["stop"] = self._set_stop
        gate.on_asked["trace"] = self._trace.begin
        self._process = os.getpid()
        if sys.platform != "win32":
            os.register_at_fork(after_in_child=self._after_fork)

    def begin_episode(self) -> int:
        """Return an episode's number at its first step."""
        self._episodes += 1
        return self._episodes - 1

    def before(self, frame: FrameType | None, numbering: Numbering, method: str) -> None:
        """Record changes, and wait for permission. `frame` has called `method`."""
        if get_ident() != self._thread:
            self._check_thread()
        if method not in self._called:
            self._tell_caller(frame, method)
        at_reset = method == "reset"
        self._numbering = numbering
        changes = self._take_changes(frame, numbering, at_reset=at_reset)
        if self.channel.is_due:
            self.gate.listen()
            self.channel.flush()
        self._look_at_stop(changes, is_end=at_reset)
        if self._most is not None and self.count >= self._most:
            self.end_at_once()
        if self._met is not None or self.count >= self.gate.allowed[0]:
            met, self._met = self._met, None
            self.gate.wait(self.count, met)

    def after(self, step: Step, numbering: Numbering) -> None:
        """Record a step in the form of the pipe."""
        self.channel.steps += step
        self.count += 1
        self._recent = (step[1], step[4], self._recent[0])
        self._last_numbering = numbering
        if self._stop is not None:
            self._last = step

    def follow(
        self, name: str, form: HeldTable, table: Any, initial: Doubles, others: Mapping[str, str]
    ) -> None:
        """Report a table whose changes `after_late` receives.

        `initial` is its content before the next reported step, and `others` has the forms of other tables by
        name.
        """
        self._late_form = form
        self._send_table(name, form, table, initial, others)

    def after_late(
        self,
        step: Step,
        numbering: Numbering,
        before: Sequence[float],
        changes: Sequence[float],
        *,
        is_end: bool,
    ) -> None:
        """Record an earlier step, with differences of the table before and after it."""
        self._add_changes(before)
        self.after(step, numbering)
        self._add_changes(changes)
        self._look_at_stop(changes, is_end=is_end)

    def end(self) -> None:
        """Report the last changes, and the end."""
        self._trace.stop()
        self.tell_rest()
        is_found = self._tracker is not None or self._late_form is not None
        if not is_found and self.wanted is not None and self.count:
            self.channel.note(f"found no table named {self.wanted} where env.step was called")
        self.channel.message(MessageKind.END, step=self.count)

    def tell_rest(self) -> None:
        """Report the last steps and changes."""
        if self.count and self._last_numbering is not None:
            self._take_changes(None, self._last_numbering, at_reset=True)
        main = sys.modules.get("__main__")
        self.channel.message(MessageKind.NUMBERS, numbers=numbers_in(None, vars(main) if main else {}))

    def end_at_once(self) -> NoReturn:
        """End the program, which it cannot prevent."""
        self.end()
        for stream in (sys.stdout, sys.stderr):
            stream.flush()
        self.channel.leave(0)

    def refuse(self, why: str) -> NoReturn:
        """End a program that cannot be watched."""
        if os.getpid() == self._process:
            self.channel.message(MessageKind.REFUSED, text=why)
        elif sys.platform != "win32":
            import signal

            self.channel.from_a_fork(MessageKind.REFUSED, text=why)
            os.kill(self._process, signal.SIGKILL)
        self.channel.leave(0)

    def _after_fork(self) -> None:
        self._thread = None

    def _check_thread(self) -> None:
        if os.getpid() != self._process:
            self.refuse(_FORKED)
        if self._thread is not None:
            self.refuse(_MANY_THREADS)
        self._thread = get_ident()

    def _take_changes(self, frame: FrameType | None, numbering: Numbering, *, at_reset: bool) -> list[float]:
        tracker = self._tracker
        if self._late_form is not None:
            if self.count >= self._next_numbers:
                self._tell_numbers(frame)
            return []
        if tracker is None:
            # before the first step, its content is not the initial one
            if self.count >= self._next_look and not (at_reset and self.count == 0):
                self._look_for_table(frame, numbering)
            return []
        states = self._recent if self._last_numbering is tracker.numbering else ()
        try:
            found = tracker.differences(frame, states, at_reset=at_reset)
        except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError):
            return self._lose_table(tracker)
        if len(found) == _CHANGE and self._traces_left <= 0:  # one cell, the usual case
            self.channel.changes += (self.count - 1 if self.count else 0, *found)
        elif found:
            self._tell_changes(found, tracker)
        if self.count >= self._next_numbers:
            self._tell_numbers(frame)
        return found

    def _lose_table(self, tracker: TableTracker) -> list[float]:
        """Give up a table with an entry that is not a number. Another one may be found."""
        self._tracker, self._next_look = None, self.count + 1
        self.channel.note(f"{tracker.way.name()} now contains something that is not a number")
        return []

    def _look_for_table(self, frame: FrameType | None, numbering: Numbering) -> None:
        self._next_look = self.count + 1 if self.count < _LOOKED_CLOSELY else int(self.count * _THEN_EVERY)
        found = candidates(frame, numbering, self.wanted)
        if found:
            others = candidates(frame, numbering, None) if self.wanted is not None else found
            self._tracker = tracker_of(found, self.wanted, self._tell_pair, self._add_changes)
            self._tell_table([each for each in others if each.value is not self._tracker.table])
            self._tell_numbers(frame)
        elif not self._turned_is_noted:
            self._tell_turned(frame, numbering)

    def _tell_turned(self, frame: FrameType | None, numbering: Numbering) -> None:
        turned = turned_table(frame, numbering)
        if turned is not None:
            self._turned_is_noted = True
            name, (rows, columns) = turned
            self.channel.note(
                f"{name} is {rows}×{columns}: did you mean {columns}×{rows} (states × actions)?"
            )

    def _tell_table(self, others: list[TableCandidate]) -> None:
        tracker = self._tracker
        assert tracker is not None
        self._is_shared = tracker.rows_are_shared()
        forms = {each.way.name(): each.form.name for each in others}
        self._send_table(tracker.way.name(), tracker.form, tracker.table, tracker.form.values(), forms)

    def _tell_pair(self, other: str, content: Doubles) -> None:
        self.channel.message(MessageKind.PAIR, step=self.count, name=other)
        self.channel.table(content)

    def _send_table(
        self, name: str, form: HeldTable, table: Any, content: Doubles, others: Mapping[str, str]
    ) -> None:
        self.channel.message(
            MessageKind.TABLE,
            step=self.count,
            name=name,
            form=form.name,
            shape=_shape_of(table, form.actions),
            dtype=str(table.dtype) if type(table) is np.ndarray else "",
            actions=form.actions,
            others=list(others),
            other_forms=list(others.values()),
            shared=self._is_shared,
        )
        self.channel.table(content)

    def _tell_changes(self, found: list[float], tracker: TableTracker) -> None:
        if self._traces_left > 0 and not self._trace.is_on:
            self._traces_left -= 1
            self._trace.begin(TRACED_AT_FIRST)
        step = max(self.count - 1, 0)
        if len(found) == _CHANGE:  # one cell, the usual case, even if each step makes a new table
            self.channel.changes += (step, *found)
        else:
            self._add_changes(found)
            if tracker.is_another and self._rebound < _MOST_REBOUND:
                self._rebound += 1
                self.channel.message(MessageKind.REBOUND, step=step)
            if not self._is_shared and tracker.rows_are_shared():
                self._is_shared = True
                self.channel.message(MessageKind.SHARED, step=step)

    def _add_changes(self, found: Sequence[float]) -> None:
        """Add changes of the last step."""
        step = max(self.count - 1, 0)
        for place in range(0, len(found), _CHANGE):
            self.channel.changes += (step, *found[place : place + _CHANGE])

    def _tell_numbers(self, frame: FrameType | None) -> None:
        self._next_numbers = 20 + self.count * 10
        numbers = numbers_in(frame, {})
        if numbers:
            self.channel.message(MessageKind.NUMBERS, numbers=numbers)

    def _tell_caller(self, frame: FrameType | None, method: str) -> None:
        self._called.add(method)
        place = users_place(frame)
        if place is not None:
            self.channel.message(MessageKind.CALLED, method=method, file=place[0], line=place[1])

    def _content(self) -> object:
        return None if self._tracker is None else self._tracker.changes_seen(self._recent)

    def _tell_lines(self, lines: Mapping[Place, int]) -> None:
        listed = [[file, line, count] for (file, line), count in lines.items()]
        if sum(lines.values()) >= TRACED_AT_FIRST:
            self._traces_left = 0
        self.channel.message(MessageKind.LINES, lines=listed)

    def _set_stop(self, said: Any) -> None:
        actions = 1 if self._numbering is None else self._numbering.actions
        self._stop = None if said is None else _StopConditions(said, actions)

    def _look_at_stop(self, changes: Sequence[float], *, is_end: bool) -> None:
        if self._stop is not None and self._last is not None:
            self._met = self._stop.met_by(self._last, changes, self._row, is_end=is_end)
            if self._met is not None:
                self._stop = None
        self._last = None

    def _row(self, state: int) -> Sequence[float]:
        table = self._late_form if self._tracker is None else self._tracker
        return () if table is None else table.row(state)


def _shape_of(table: Any, actions: int) -> list[int]:
    if type(table) is np.ndarray:
        return list(table.shape)
    return [dict.__len__(table)] if issubclass(type(table), dict) else [len(table), actions]
