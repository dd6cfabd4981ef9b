"""A watched program: file, process, log and steps."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Mapping
from functools import cached_property
from pathlib import Path
from typing import Any, Final

from rl_tui.common.errors import UserError
from rl_tui.common.findings import one_line, shown
from rl_tui.common.limits import LARGEST_SOURCE
from rl_tui.common.text_file import UnreadableError, open_plain
from rl_tui.programs.watched.child.script import check_script
from rl_tui.programs.watched.messages import NO_LIMIT
from rl_tui.programs.watched.notebook import Notebook, is_notebook, place_in_words, read_notebook
from rl_tui.programs.watched.program_log import ProgramError, ProgramLog
from rl_tui.programs.watched.program_process import ProgramProcess, ProgramRequest
from rl_tui.programs.watched.program_world import ProgramWorld, world_of_program

# The file


LOOKS: Final = 0.1
"""Seconds between two looks at the file."""
SETTLED: Final = 0.3
"""Seconds without a change before a save counts."""


class ProgramFile:
    """Watches a file for changes. `clock` returns seconds."""

    def __init__(self, path: Path, clock: Callable[[], float]) -> None:
        self.path = path
        self.source: tuple[str, ...]
        """Lines of the file when the program was started."""
        self.notebook: Notebook | None
        """The notebook that the file was then, if it is one."""
        self.read_again()
        self._clock = clock
        self._stamp = self._seen = _stamp(path)
        self._looked_at = self._changed_at = clock()

    def was_saved(self) -> bool:
        """Return True once after each save, when the file is stable."""
        now = self._clock()
        if now - self._looked_at < LOOKS:
            return False
        self._looked_at = now
        stamp = _stamp(self.path)
        if stamp != self._seen:
            self._seen, self._changed_at = stamp, now
        if self._seen == self._stamp or self._seen is None or now - self._changed_at < SETTLED:
            return False
        self._stamp = self._seen
        return True

    def fault(self) -> str:
        """Return the syntax error in one line, or ""."""
        try:
            check_script(self.path)
        except UserError as fault:
            return str(fault)
        return ""

    def read_again(self) -> None:
        """Use the current lines of the file."""
        self.source = _lines(self.path)
        self.notebook = _notebook(self.path)


def _stamp(path: Path) -> tuple[int, int] | None:
    try:
        found = os.stat(path)
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size


def _lines(path: Path) -> tuple[str, ...]:
    try:
        with open_plain(path, "a Python file") as file:
            return tuple(file.read(LARGEST_SOURCE).decode("utf-8", "replace").splitlines())
    except (OSError, UnreadableError):
        return ()


def _notebook(path: Path) -> Notebook | None:
    try:
        return read_notebook(path) if is_notebook(path) else None
    except UserError:
        return None


# The process


_LOOK: Final = 0.05
_TRACED: Final = 40  # changes
_LONGEST: Final = 300


class WatchedProgram:
    """The process of `request`, which takes no step without permission. Raises UserError if it cannot start.

    At rest it waits for permission, and all its steps and changes are known.
    """

    def __init__(self, request: ProgramRequest) -> None:
        self.request = request
        self.log = ProgramLog()
        self.heard_at = time.monotonic()
        self.is_at_rest = False
        """True while it waits for permission."""
        self.is_over = False
        """True if it takes no further step."""
        self.is_settled = False
        """True if no message comes without permission: it rests or has ended."""
        self.stopped_by: str | None = None
        """The event at which it rests, as in messages.py."""
        self.known = 0
        """Number of fully known steps."""
        self._limit = 0
        self._asked: dict[str, Any] | None = None
        try:
            self._process = ProgramProcess(request, allowed=0)
        except OSError as error:
            raise UserError(f"{_name(request)}: cannot start a process: {error.strerror}") from error

    @property
    def exit_status(self) -> int | None:
        """Exit status, if it has ended."""
        return self._process.exit_status

    def _look(self) -> None:
        log, process = self.log, self._process
        self.is_at_rest = log.waiting_at is not None and log.heard == process.asked
        self.is_over = log.ended or process.closed
        self.is_settled = self.is_at_rest or self.is_over
        self.stopped_by = log.stopped_by if self.is_at_rest else None
        self.known = log.recording.count if self.is_settled else max(log.recording.count - 1, 0)

    @cached_property
    def world(self) -> ProgramWorld:
        """World of the first environment. Raises UserError if it is too large."""
        return world_of_program(self.log.environments[0])

    def let(self, steps: int = NO_LIMIT) -> None:
        """Permit `steps` in all, also after an event."""
        has_met = self.stopped_by is not None
        if self.is_over or (steps == self._limit and not has_met):
            return
        self._limit = steps
        # after an event it waits for the next events to stop at
        goes_on = has_met and steps > self.log.recording.count
        self._process.allow(steps, {"stop": self._asked} if goes_on else None)
        self._look()

    def stop_at(self, asked: Mapping[str, Any]) -> None:
        """Set the events to stop at, as in messages.py."""
        wanted = dict(asked) or None
        if wanted == self._asked and "episode_ends" not in asked:  # episodes are counted from now on
            return
        self._asked = wanted
        if self.stopped_by is None:
            self._process.ask({"stop": wanted})
            self._look()

    def trace(self) -> None:
        """Report the lines of the next changes, at a fifth of the speed."""
        if not self.is_over:
            self._process.ask({"trace": _TRACED})
            self._look()

    def hold(self) -> None:
        """Permit no further step."""
        if not self.is_settled:
            self.let(0)

    def listen(self, seconds: float = 0.0) -> bool:
        """Return True if messages came within `seconds`."""
        found, stood_at = False, self.log.stands_at
        for letter, payload in self._process.frames(seconds):
            self.log.take(letter, payload)
            found = True
        if found and self.log.stands_at in (None, stood_at):  # its position in the code is reported instead
            self.heard_at = time.monotonic()
        self._look()
        return found

    def end(self) -> None:
        """Kill it with all its processes."""
        self._process.end()
        self._look()

    def wait_for_environment(self, is_wanted: Callable[[], bool] = lambda: True) -> None:
        """Wait until it is ready for its first step, or has ended. Raises UserError if it cannot."""
        while is_wanted():
            self.listen(_LOOK)
            self.check()
            if self.log.environments and self.is_settled:
                return

    def check(self) -> None:
        """Raise UserError if it ended without an environment, or was refused."""
        log = self.log
        if log.environments or not (self.is_over or log.refused):
            return
        raise UserError(f"{_name(self.request)}: {_why_nothing_is_shown(log)}")


def _why_nothing_is_shown(log: ProgramLog) -> str:
    if log.refused:
        return one_line(log.refused, _LONGEST)
    if log.error is not None:
        return error_in_words(log.error)
    why = "; ".join(log.notes) or "expected gymnasium.make, with discrete observations and actions"
    return one_line(f"it ended before its first step: {why}", _LONGEST)


def error_in_words(error: ProgramError) -> str:
    """Return the exception in one line, with its place."""
    place = "" if error.line is None else f" in {place_in_words(error.file, error.line)}"
    return one_line(f"{error.type}{place}: {error.text}", _LONGEST)


def _name(request: ProgramRequest) -> str:
    return shown(str(request.path))[1:-1]
