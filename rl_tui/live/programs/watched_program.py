"""A program that is watched: its file; its process, what it has told, and how it is held back and let go."""

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
from rl_tui.programs.watched.program_log import ProgramError, ProgramLog
from rl_tui.programs.watched.program_process import ProgramProcess, ProgramRequest
from rl_tui.programs.watched.program_world import ProgramWorld, world_of_program

# The file


LOOKS: Final = 0.1
"""Seconds between two looks at the file."""
SETTLED: Final = 0.3
"""So many seconds after it was saved last it counts."""


class ProgramFile:
    """Looks whether the file at ``path`` was saved; ``clock`` gives seconds."""

    def __init__(self, path: Path, clock: Callable[[], float]) -> None:
        self.path = path
        self.source: tuple[str, ...] = _lines(path)
        """Its lines as they were when the program was started."""
        self._clock = clock
        self._stamp = self._seen = _stamp(path)
        self._looked_at = self._changed_at = clock()

    def was_saved(self) -> bool:
        """Return whether it is another file than before, and has been for a moment; once for each time."""
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
        """Return what keeps its text from being a program, in one line; empty where nothing does."""
        try:
            check_script(self.path)
        except UserError as fault:
            return str(fault)
        return ""

    def read_again(self) -> None:
        """Take its lines as they are now for those of the program."""
        self.source = _lines(self.path)


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


# The process


_LOOK: Final = 0.05
_TRACED: Final = 40  # changes
_LONGEST: Final = 300


class WatchedProgram:
    """The program of ``request``, which takes no step before it is let. Raises OSError, UserError.

    It is at rest where it waits for leave to take its next step; all its steps and the changes that they made
    are known then.
    """

    def __init__(self, request: ProgramRequest) -> None:
        self.request = request
        self.log = ProgramLog()
        """What it has told."""
        self.heard_at = time.monotonic()
        """When it last told something."""
        self._limit = 0
        self._asked: dict[str, Any] | None = None
        try:
            self._process = ProgramProcess(request, allowed=0)
        except OSError as error:
            raise UserError(f"{_name(request)}: no process can be started: {error.strerror}") from error

    @property
    def exit_status(self) -> int | None:
        """How its process ended, None while it lives."""
        return self._process.exit_status

    @property
    def is_over(self) -> bool:
        """Whether it takes no further step."""
        return self.log.ended or self._process.closed

    @property
    def is_at_rest(self) -> bool:
        """Whether it waits."""
        log = self.log
        return log.waiting_at is not None and log.heard == self._process.asked

    @property
    def stopped_by(self) -> str | None:
        """What it met where it rests, as messages.py names it; None where that is nothing."""
        return self.log.stopped_by if self.is_at_rest else None

    @property
    def is_settled(self) -> bool:
        """Whether nothing comes before it is let go on: it waits, or is over."""
        return self.is_at_rest or self.is_over

    @property
    def known(self) -> int:
        """How many steps are known with all that they changed."""
        count = self.log.recording.count
        return count if self.is_settled else max(count - 1, 0)

    @cached_property
    def world(self) -> ProgramWorld:
        """The world of the first environment that it made. Raises UserError where it is too large."""
        return world_of_program(self.log.environments[0])

    def let(self, steps: int = NO_LIMIT) -> None:
        """Let it take steps until it has taken so many in all, also where it has met something."""
        has_met = self.stopped_by is not None
        if self.is_over or (steps == self._limit and not has_met):
            return
        self._limit = steps
        # where it met something it waits to hear anew what it is to stop at
        goes_on = has_met and steps > self.log.recording.count
        self._process.allow(steps, {"stop": self._asked} if goes_on else None)

    def go_on(self) -> None:
        """Let it go as far as it may already, where it has met something."""
        self.let(self._limit)

    def stop_at(self, asked: Mapping[str, Any]) -> None:
        """Have it stop where something happens, as messages.py has it, from its next step on if it waits.

        Elsewhere it hears that within a moment.
        """
        wanted = dict(asked) or None
        if wanted == self._asked and "episode_ends" not in asked:  # those are counted from now on
            return
        self._asked = wanted
        if self.stopped_by is None:
            self._process.ask({"stop": wanted})

    def trace(self) -> None:
        """Have it tell the lines of its next changes, for a while at a fifth of its speed."""
        if not self.is_over:
            self._process.ask({"trace": _TRACED})

    def hold(self) -> None:
        """Let it take no step beyond the one it is in."""
        if not self.is_settled:
            self.let(0)

    def listen(self, seconds: float = 0.0) -> bool:
        """Take in what it tells, waiting for at most so many seconds; return whether there was anything."""
        found, stood_at = False, self.log.stands_at
        for letter, payload in self._process.frames(seconds):
            self.log.take(letter, payload)
            found = True
        if found and self.log.stands_at in (None, stood_at):  # where it stands is told in its stead
            self.heard_at = time.monotonic()
        return found

    def end(self) -> None:
        """End it at once, and all that it started."""
        self._process.end()

    def wait_for_environment(self, is_wanted: Callable[[], bool] = lambda: True) -> None:
        """Wait until it has made an environment and stands before its first step, or is over.

        Raises UserError where it is over without an environment that can be shown, or cannot be watched.
        """
        while is_wanted():
            self.listen(_LOOK)
            self.check()
            if self.log.environments and self.is_settled:
                return

    def check(self) -> None:
        """Raise UserError where it cannot be shown: it is over without an environment, or refused."""
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
    return one_line(f"it ended without an environment that can be watched: {why}", _LONGEST)


def error_in_words(error: ProgramError) -> str:
    """Return what a program raised, in one line, with its place."""
    place = "" if error.line is None else f"line {error.line}: "
    return one_line(f"{place}{error.type}: {error.text}", _LONGEST)


def _name(request: ProgramRequest) -> str:
    return shown(str(request.path))[1:-1]
