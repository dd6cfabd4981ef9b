"""The lines of the user's code that change the table."""

from __future__ import annotations

import ast
import sys
from collections import Counter
from collections.abc import Callable, Mapping
from types import CodeType, FrameType
from typing import Any, Final

from rl_tui.programs.watched.child.errors import is_users_file, line_of, with_callers
from rl_tui.programs.watched.child.script import loaded_tree

Place = tuple[str, int]
TRACED_AT_FIRST: Final = 40
MOST_LINES: Final = 20_000
"""Most lines executed while tracing. With rare changes, it would slow the program for long."""


class LineTrace:
    """Finds the lines that change the table, then leaves the code at full speed.

    `look` returns a value that changes with the table, and `tell` receives the number of changes by line.
    """

    def __init__(
        self,
        look: Callable[[], object],
        tell: Callable[[Mapping[Place, int]], None],
    ) -> None:
        self._look, self._tell = look, tell
        self._statements = _Statements()
        self._is_users: dict[str, bool] = {}
        self._changes: Counter[Place] = Counter()
        self._wanted = self._lines_left = 0
        self._seen: object = None
        self._place: Place | None = None
        self._hooks = _Monitoring(self) if sys.version_info >= (3, 12) else _Tracing(self)

    @property
    def is_on(self) -> bool:
        """True while tracing."""
        return self._wanted > 0

    def begin(self, changes: int) -> None:
        """Trace the next `changes` changes, in the calling code."""
        if changes > 0 and (self.is_on or self._hooks.begin(sys._getframe(1))):
            self._wanted, self._lines_left = changes, MOST_LINES
            self._seen, self._place = self._look(), self._place_of(sys._getframe(1))

    def stop(self) -> None:
        """Stop, and report the results."""
        if self.is_on:
            self._wanted = 0
            self._hooks.stop(sys._getframe(1))
            found = Counter[Place]()
            for (file, line), count in self._changes.items():
                found[file, self._statements.first_line(file, line)] += count
            self._changes.clear()
            self._tell(found)

    def is_users(self, code: CodeType) -> bool:
        """Return True for the user's own code."""
        file = code.co_filename
        known = self._is_users.get(file)
        if known is None:
            known = self._is_users[file] = is_users_file(file)
        return known

    def at_line(self, file: str, line: int) -> None:
        """Note a line about to run. The previous one made any change."""
        self._find_change()
        self._place = (file, line)
        self._lines_left -= 1
        if self._lines_left <= 0 or self._changes.total() >= self._wanted:
            self.stop()

    def at_return(self, caller: FrameType | None) -> None:
        """Note a return to `caller`, whose line continues."""
        self._find_change()
        self._place = self._place_of(caller)

    def _find_change(self) -> None:
        seen = self._look()
        if seen != self._seen:
            self._seen = seen
            if self._place is not None:
                self._changes[self._place] += 1

    def _place_of(self, frame: FrameType | None) -> Place | None:
        users = (each for each in with_callers(frame) if self.is_users(each.f_code))
        return next(((each.f_code.co_filename, line_of(each)) for each in users), None)


class _Tracing:
    def __init__(self, trace: LineTrace) -> None:
        self._trace = trace

    def begin(self, frame: FrameType | None) -> bool:
        """Return False if a debugger is active."""
        if sys.gettrace() is not None:
            return False
        for each in with_callers(frame):
            if self._trace.is_users(each.f_code):
                each.f_trace = self._in_function
        sys.settrace(self._at_call)
        return True

    def stop(self, frame: FrameType | None) -> None:
        sys.settrace(None)
        for each in with_callers(frame):
            if each.f_trace == self._in_function:
                each.f_trace = None

    def _at_call(self, frame: FrameType, event: str, _: Any) -> Any:
        return self._in_function if event == "call" and self._trace.is_users(frame.f_code) else None

    def _in_function(self, frame: FrameType, event: str, _: Any) -> Any:
        if self._trace.is_on and event == "line":
            self._trace.at_line(frame.f_code.co_filename, frame.f_lineno)
        elif self._trace.is_on and event == "return":
            self._trace.at_return(frame.f_back)
        return self._in_function if self._trace.is_on else None


class _Monitoring:
    def __init__(self, trace: LineTrace) -> None:
        self._trace = trace
        self._tool = -1

    def begin(self, _: FrameType | None) -> bool:
        """Return False if all tool ids are taken."""
        if sys.version_info >= (3, 12):
            monitoring = sys.monitoring
            free = [tool for tool in range(5, -1, -1) if monitoring.get_tool(tool) is None]
            if not free:
                return False
            self._tool, events = free[0], monitoring.events
            monitoring.use_tool_id(self._tool, "rl-tui")
            monitoring.register_callback(self._tool, events.LINE, self._at_line)
            monitoring.register_callback(self._tool, events.PY_RETURN, self._at_return)
            monitoring.register_callback(self._tool, events.PY_YIELD, self._at_return)
            monitoring.set_events(self._tool, events.LINE | events.PY_RETURN | events.PY_YIELD)
            monitoring.restart_events()
        return True

    def stop(self, _: FrameType | None) -> None:
        if sys.version_info >= (3, 12):
            events = sys.monitoring.events
            sys.monitoring.set_events(self._tool, 0)
            for event in (events.LINE, events.PY_RETURN, events.PY_YIELD):
                sys.monitoring.register_callback(self._tool, event, None)
            sys.monitoring.free_tool_id(self._tool)

    def _at_line(self, code: CodeType, line: int) -> Any:
        if not self._trace.is_users(code):
            return _never_again()
        if self._trace.is_on:
            self._trace.at_line(code.co_filename, line)
        return None

    def _at_return(self, code: CodeType, *_: Any) -> Any:
        if not self._trace.is_users(code):
            return _never_again()
        if self._trace.is_on:
            self._trace.at_return(sys._getframe(1).f_back)
        return None


def _never_again() -> Any:
    if sys.version_info >= (3, 12):
        return sys.monitoring.DISABLE
    return None


class _Statements:
    def __init__(self) -> None:
        self._first_lines: dict[str, dict[int, int]] = {}

    def first_line(self, file: str, line: int) -> int:
        if file not in self._first_lines:
            self._first_lines[file] = self._read(file)
        return self._first_lines[file].get(line, line)

    def _read(self, file: str) -> dict[int, int]:
        tree = loaded_tree(file)
        found: dict[int, int] = {}
        for node in [] if tree is None else ast.walk(tree):  # from the outside in
            if isinstance(node, ast.stmt):
                body = getattr(node, "body", None)
                end = body[0].lineno - 1 if body else node.end_lineno or node.lineno
                found.update(dict.fromkeys(range(node.lineno, end + 1), node.lineno))
        return found
