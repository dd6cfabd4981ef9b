"""What a program does, step by step: counted, compared with before, and told to the watching side."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping, Sequence
from threading import get_ident
from types import FrameType
from typing import Any, Final, NoReturn

import numpy as np

from rl_tui.lab.programs.child.channel import Channel
from rl_tui.lab.programs.child.code_numbers import numbers_in
from rl_tui.lab.programs.child.environments.numbering import Numbering
from rl_tui.lab.programs.child.faults import users_place
from rl_tui.lab.programs.child.gate import Gate
from rl_tui.lab.programs.child.line_trace import TRACED_AT_FIRST, LineTrace, Place
from rl_tui.lab.programs.child.stopping import StepSeen, StopConditions
from rl_tui.lab.programs.child.tables.search import TableCandidate, candidates, turned_table
from rl_tui.lab.programs.child.tables.tracker import TableTracker
from rl_tui.lab.programs.messages import MessageKind

_LOOKED_CLOSELY: Final = 200  # steps, before each of which the table is looked for
_THEN_EVERY: Final = 1.05  # times as many steps as before
Step = tuple[int, int, int, float, int, int, int, int]
"""A step as it goes through the pipe."""
_NUMBERS: Final = 3  # of each difference
_MOST_TRACES: Final = 2  # times that lines are looked at, while too few of them were found
_MOST_REBOUND: Final = 1_000  # messages that say so
_MANY_THREADS: Final = "more than one thread takes steps, and whose step a change belongs to cannot be known"
_FORKED: Final = "a process that the program forked takes steps, and its table is not this process's"


class Recorder:
    """Sees every step of the program. ``most`` ends it after so many, ``wanted`` names its table."""

    def __init__(self, channel: Channel, gate: Gate, *, most: int | None, wanted: str | None) -> None:
        self.channel, self.gate = channel, gate
        self.count = 0
        """How many steps were taken in all."""
        self._most, self._wanted = most, wanted
        self._tracker: TableTracker | None = None
        self._next_look = self._next_numbers = 0
        self._episodes = self._rebound = 0
        self._recent: tuple[int, ...] = (0,)
        self._last: tuple[int, int, float, int, int] | None = (
            None  # until the next call: what a stop looks at
        )
        self._last_numbering: Numbering | None = None
        self._numbering: Numbering | None = None
        self._stop: StopConditions | None = None
        self._met: str | None = None
        self._thread: int | None = None
        self._called: set[str] = set()
        self._is_shared = self._turned_is_noted = False
        self._traces_left = _MOST_TRACES
        self._trace = LineTrace(self._content, self._tell_lines)
        gate.on_asked["stop"] = self._set_stop
        gate.on_asked["trace"] = self._trace.begin
        self._process = os.getpid()
        os.register_at_fork(after_in_child=self._after_fork)

    def begin_episode(self) -> int:
        """Return the number of an episode that takes its first step."""
        self._episodes += 1
        return self._episodes - 1

    def before(self, frame: FrameType | None, numbering: Numbering, method: str) -> None:
        """Take in what happened since the last call, and wait if it goes no further.

        ``frame`` is what called ``method``.
        """
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
        if self._stop is not None and self._last is not None:
            self._look_at_stop(StepSeen(*self._last, changes), is_end=at_reset)
        self._last = None
        if self._most is not None and self.count >= self._most:
            self.end_at_once()
        if self._met is not None or self.count >= self.gate.allowed[0]:
            met, self._met = self._met, None
            self.gate.wait(self.count, met)

    def after(self, step: Step, numbering: Numbering) -> None:
        """Take in a step as it goes through the pipe."""
        self.channel.steps += step
        self.count += 1
        state, next_state = step[1], step[4]
        self._recent = (state, next_state, self._recent[0])
        self._last_numbering = numbering
        if self._stop is not None:
            self._last = (state, step[2], step[3], next_state, step[6])

    def end(self) -> None:
        """Tell what changed since the last step, and that the program is over."""
        self._trace.stop()
        self.tell_rest()
        if self._tracker is None and self._wanted is not None and self.count:
            text = f"no table is called {self._wanted} where env.step was called"
            self.channel.message(MessageKind.NOTE, text=text)
        self.channel.message(MessageKind.END, step=self.count)

    def tell_rest(self) -> None:
        """Tell the last steps, and what changed since."""
        if self.count and self._last_numbering is not None:
            self._take_changes(None, self._last_numbering, at_reset=True)
        main = sys.modules.get("__main__")
        self.channel.message(MessageKind.NUMBERS, numbers=numbers_in(None, vars(main) if main else {}))

    def end_at_once(self) -> NoReturn:
        """End the program where it stands, which it cannot prevent."""
        self.end()
        for stream in (sys.stdout, sys.stderr):
            stream.flush()
        self.channel.leave(0)

    def refuse(self, why: str) -> NoReturn:
        """End the program, which cannot be watched."""
        if os.getpid() == self._process:
            self.channel.message(MessageKind.REFUSED, text=why)
        else:
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
        if tracker is None:
            # before the first step its content is not yet what it starts from
            if self.count >= self._next_look and not (at_reset and self.count == 0):
                self._look_for_table(frame, numbering)
            return []
        states = self._recent if self._last_numbering is tracker.numbering else ()
        try:
            found = tracker.differences(frame, states, at_reset=at_reset)
        except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError):
            return self._lose_table(tracker)
        if len(found) == _NUMBERS and self._traces_left <= 0:  # one cell, as most steps change
            self.channel.changes += (self.count - 1 if self.count else 0, *found)
        elif found:
            self._tell_changes(found, tracker)
        if self.count >= self._next_numbers:
            self._tell_numbers(frame)
        return found

    def _lose_table(self, tracker: TableTracker) -> list[float]:
        """Give up a table with something in it that is no number; another one may be found."""
        self._tracker, self._next_look = None, self.count + 1
        text = f"{tracker.way.name()} holds something that is no number any more"
        self.channel.message(MessageKind.NOTE, text=text)
        return []

    def _look_for_table(self, frame: FrameType | None, numbering: Numbering) -> None:
        self._next_look = self.count + 1 if self.count < _LOOKED_CLOSELY else int(self.count * _THEN_EVERY)
        found = candidates(frame, numbering, self._wanted)
        if found:
            others = candidates(frame, numbering, None) if self._wanted is not None else found
            self._tracker = TableTracker(found[0], self._wanted)
            self._tell_table([each for each in others if each.value is not found[0].value])
            self._tell_numbers(frame)
        elif not self._turned_is_noted:
            self._tell_turned(frame, numbering)

    def _tell_turned(self, frame: FrameType | None, numbering: Numbering) -> None:
        """Tell of an array that would be the table if its axes were changed over."""
        turned = turned_table(frame, numbering)
        if turned is not None:
            self._turned_is_noted = True
            name, (rows, columns) = turned
            text = f"{name} is {rows}×{columns}: did you mean {columns}×{rows} (states × actions)?"
            self.channel.message(MessageKind.NOTE, text=text)

    def _tell_table(self, others: list[TableCandidate]) -> None:
        tracker = self._tracker
        assert tracker is not None
        numbering, table = tracker.numbering, tracker.table
        self._is_shared = tracker.rows_are_shared()
        self.channel.message(
            MessageKind.TABLE,
            step=self.count,
            name=tracker.way.name(),
            form=tracker.form.name,
            shape=_shape_of(table, numbering.actions),
            dtype=str(table.dtype) if type(table) is np.ndarray else "",
            actions=numbering.actions,
            others=[each.way.name() for each in others],
            other_forms=[each.form.name for each in others],
            shared=self._is_shared,
        )
        self.channel.table(tracker.form.values())

    def _tell_changes(self, found: list[float], tracker: TableTracker) -> None:
        if self._traces_left > 0 and not self._trace.is_on:
            self._traces_left -= 1
            self._trace.begin(TRACED_AT_FIRST)
        step = max(self.count - 1, 0)
        if len(found) == _NUMBERS:  # one cell, as most steps change, also where each binds the table anew
            self.channel.changes += (step, *found)
        else:
            for place in range(0, len(found), _NUMBERS):
                self.channel.changes += (step, *found[place : place + _NUMBERS])
            if tracker.is_another and self._rebound < _MOST_REBOUND:
                self._rebound += 1
                self.channel.message(MessageKind.REBOUND, step=step)
            if not self._is_shared and tracker.rows_are_shared():
                self._is_shared = True
                self.channel.message(MessageKind.SHARED, step=step)

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
        self._stop = None if said is None else StopConditions(said, actions)

    def _look_at_stop(self, step: StepSeen, *, is_end: bool) -> None:
        if self._stop is not None:
            self._met = self._stop.met_by(step, self._row, is_end=is_end)
            if self._met is not None:
                self._stop = None

    def _row(self, state: int) -> Sequence[float]:
        return () if self._tracker is None else self._tracker.form.row(state)


def _shape_of(table: Any, actions: int) -> list[int]:
    """Return the sizes of an array or of lists; of a dict how many entries it has."""
    if type(table) is np.ndarray:
        return list(table.shape)
    return [dict.__len__(table)] if issubclass(type(table), dict) else [len(table), actions]
