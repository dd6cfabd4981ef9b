"""The process of a watched program, seen from the watching side."""

from __future__ import annotations

import json
import math
import mmap
import os
import re
import select
import signal
import subprocess
import sys
import tempfile
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, NamedTuple

from rl_tui.common.findings import printable
from rl_tui.programs.watched.messages import HEADER, LARGEST_FRAME, NO_LIMIT, OWN_MESSAGE, MessageKind
from rl_tui.programs.watched.program_log import GARBLED, ProgramError, ProgramLog

# Output, cut into lines


LONGEST_LINE: Final = 500
"""Longest stored line in characters."""
MOST_A_SECOND: Final = 300
"""Most lines per second. Of more, only the last ones are kept."""
LAST_KEPT: Final = 20
"""Number of last lines kept."""

_LONGEST_RAW: Final = 4 * LONGEST_LINE  # bytes; a character has at most four
# cursor and colour sequences: CSI, OSC, and others of two characters
_ESCAPES: Final = re.compile(r"\x1b(?:\[[0-?]*[ -/]*[@-~]|\][^\x07\x1b]*(?:\x07|\x1b\\)?|[@-Z\\-_])")


class WrittenLine(NamedTuple):
    """A line that may replace its beginning or an earlier state."""

    text: str
    replaces: bool


class WrittenLines:
    """The lines of one stream, assembled from pieces of any size in bounded memory. A carriage return
    restarts a line, as in progress bars. An unfinished line is reported at once, and again as it grows.
    """

    def __init__(self) -> None:
        self._rest = b""
        self._is_begun = False  # of the unfinished line
        self._second = -1
        self._room = MOST_A_SECOND
        self._left_out = 0
        self._last: deque[bytes] = deque(maxlen=LAST_KEPT)

    def take(self, piece: bytes, now: float) -> Iterator[WrittenLine]:
        """Yield the lines known after `piece`, which arrived at `now` (seconds on any clock)."""
        if int(now) != self._second:
            yield from self._catch_up()
            self._second, self._room = int(now), MOST_A_SECOND
        *lines, rest = (self._rest + piece).split(b"\n", self._room)
        for line in lines:
            yield self._written(line)
        self._room -= len(lines)
        self._rest = _shortened(self._without_flood(rest))
        if self._room and self._rest.strip():
            text, replaces = self._written(self._rest)
            self._is_begun = True
            yield WrittenLine(text, replaces)

    def end(self) -> Iterator[WrittenLine]:
        """Yield the remaining lines at the end."""
        yield from self._catch_up()
        if self._rest.strip() and not self._is_begun:
            yield self._written(self._rest)

    def _without_flood(self, text: bytes) -> bytes:
        """Count the complete lines in `text`, keep the last ones, and return the unfinished one."""
        *flood, rest = text.rsplit(b"\n", LAST_KEPT + 1)
        if flood:
            self._left_out += text.count(b"\n")
            self._last.extend(flood[-LAST_KEPT:])
            self._is_begun = False
        return rest

    def _catch_up(self) -> Iterator[WrittenLine]:
        """Yield the number of skipped lines, and the last ones of them."""
        left_out = self._left_out - len(self._last)
        if left_out > 0:
            yield WrittenLine(f"… {left_out:,} lines left out", False)
        for line in self._last:
            yield WrittenLine(_text_of(line), False)
        self._last.clear()
        self._left_out = 0

    def _written(self, line: bytes) -> WrittenLine:
        replaces, self._is_begun = self._is_begun, False
        return WrittenLine(_text_of(line), replaces)


def _shortened(line: bytes) -> bytes:
    """Return the part of an unfinished line that its text needs, with a sign that it was longer."""
    if len(line) > _LONGEST_RAW:
        line = line[line.rfind(b"\r", 0, len(line) - 1) + 1 :]
    return line[: _LONGEST_RAW + 1]


def _text_of(line: bytes) -> str:
    """Return what a terminal would show of `line`, without control characters."""
    line = line.rstrip(b"\r")
    shown = line[line.rfind(b"\r") + 1 :][: _LONGEST_RAW + 1].decode("utf-8", "replace")
    text = printable(_ESCAPES.sub("", shown).expandtabs(8)).rstrip()
    return text if len(text) <= LONGEST_LINE else text[: LONGEST_LINE - 1] + "…"


# The process


_CHUNK: Final = 1 << 20
_LOOK_AGAIN: Final = 0.5  # seconds between checks that the process lives
_BEHIND_OUTPUT: Final = 10  # milliseconds in which an earlier step arrives after output
_FAREWELL: Final = 1.0  # seconds that a process may take to end after its pipe is closed
_CLOSED_ITS_PIPE: Final = "the program closed the pipe by which it was watched, and was ended"
_ENVIRONMENT: Final = {"PYTHONHASHSEED": "0", "MPLBACKEND": "Agg", "SDL_VIDEODRIVER": "dummy"}
# ascii, because the command line uses the encoding of the system
_SCRIPT: Final = """\
import sys
sys.path[:] = {path!a}
from rl_tui.programs.watched.child.main import main
main({said!a})
"""


@dataclass(frozen=True, slots=True)
class ProgramRequest:
    """A program to run: a script, or an agent without a loop.

    Attributes:
        path: File of the program.
        arguments: Arguments of a script.
        seed: Seed of all generators.
        steps: Limit of steps, if any.
        table: Name of the table, if given by the user.
        agent: Class or function of an agent ("" for the only one), or None for a script.
        scenario: Id or path, for an agent.
        scenario_seed: Seed of the world, default `seed`.
        episodes: Episodes of an agent.
        hyperparameters: Numbers from the user by name.
        defaults: Numbers for parameters without a default.
        memory: Memory limit in bytes, if any.
    """

    path: Path
    arguments: tuple[str, ...] = ()
    seed: int = 0
    steps: int | None = None
    table: str | None = None
    agent: str | None = None
    scenario: str = ""
    scenario_seed: int | None = None
    episodes: int | None = None
    hyperparameters: Mapping[str, float] | None = None
    defaults: Mapping[str, float] | None = None
    memory: int | None = None


class ProgramProcess:
    """The process of `request` in its own session, until `end`. It may take `allowed` steps at first. It
    ends with this process, together with everything it started in its session.

    Raises:
        OSError: The process cannot be started.
    """

    def __init__(self, request: ProgramRequest, allowed: int = NO_LIMIT) -> None:
        if not hasattr(select, "poll"):
            raise OSError("programs can be watched on Linux and macOS only")
        if not sys.executable:
            raise FileNotFoundError("the Python version is not known")
        with ExitStack() as to_close, ExitStack() as of_the_child:
            pipes = [_pipe(to_close, of_the_child) for _ in range(3)]
            (self._reading, reports), *_ = pipes
            asked, self._asking = _pipe(of_the_child, to_close)
            life, _ = _pipe(of_the_child, to_close)
            shared = _memory_file(of_the_child)
            memory = to_close.enter_context(mmap.mmap(shared, mmap.PAGESIZE))
            self._allowed = to_close.enter_context(memoryview(memory).cast("q"))
            self._allowed[0] = allowed
            descriptors = {"reports": reports, "asked": asked, "life": life, "shared": shared}
            self._process = subprocess.Popen(
                [sys.executable, "-P", "-c", _script(request, descriptors)],
                stdin=subprocess.DEVNULL,
                stdout=pipes[1][1],
                stderr=pipes[2][1],
                env=os.environ | _ENVIRONMENT,
                pass_fds=descriptors.values(),
                start_new_session=True,
            )
            self._to_close = to_close.pop_all()
        self._listen(pipes[1][0], pipes[2][0])

    def allow(self, steps: int, what: Mapping[str, Any] | None = None) -> None:
        """Allow `steps` in all, 0 to stop at the next one. It reads `what`, if given, before its next
        step.
        """
        if not self.closed:
            self._allowed[0] = steps
            self.ask(what or {})

    def ask(self, what: Mapping[str, Any]) -> None:
        """Send a request, which it reads when it waits. This never blocks."""
        if not self.closed:
            self.asked += 1
            self._unsent += json.dumps({"number": self.asked, **what}).encode() + b"\n"
            self._send()

    def frames(self, seconds: float | None = 0.0) -> Iterator[tuple[bytes, bytes]]:
        """Return new frames, waiting up to `seconds` (None for no limit). Output of the program is
        included, after the steps taken before it. The last frame is a message about its end.
        """
        if self.closed:
            return iter(())
        self._send()
        self._wait(seconds)
        over = self._read_frames()
        found = list(self._whole_frames())
        found += self._read_output()
        if over or self._is_garbled:
            found += self._farewell()
        return iter(found)

    def end(self) -> None:
        """Kill it and everything that it started."""
        self._kill()
        self._process.wait()
        self._to_close.close()
        self.closed = True

    def _listen(self, stdout: int, stderr: int) -> None:
        """Prepare nonblocking pipes."""
        os.set_blocking(self._asking, False)
        self._unsent = b""
        self.asked = 0
        """Number of requests so far."""
        self._bytes = bytearray()
        self._streams = {stdout: ("out", WrittenLines()), stderr: ("err", WrittenLines())}
        self._poll, self._poll_steps = select.poll(), select.poll()
        self._poll_steps.register(self._reading, select.POLLIN)
        for descriptor in (self._reading, *self._streams):
            os.set_blocking(descriptor, False)
            self._poll.register(descriptor, select.POLLIN)
        self.closed = False
        """True once nothing more will arrive."""

    @property
    def exit_status(self) -> int | None:
        """Exit status of the process, or None while it runs."""
        return self._process.poll()

    def _send(self) -> None:
        with suppress(OSError):  # it has ended, or its pipe is full
            while self._unsent:
                self._unsent = self._unsent[os.write(self._asking, self._unsent) :]

    def _wait(self, seconds: float | None) -> None:
        """Wait until there is something to read, or the process has ended. Its child may keep the pipe
        open, so the process is checked regularly.
        """
        until = None if seconds is None else time.monotonic() + seconds
        while True:
            left = _LOOK_AGAIN if until is None else min(_LOOK_AGAIN, until - time.monotonic())
            ready = self._poll.poll(max(0.0, left) * 1000)
            if ready and all(descriptor != self._reading for descriptor, _ in ready):
                self._poll_steps.poll(_BEHIND_OUTPUT)  # the step that the output belongs to
            if ready or self._process.poll() is not None:
                return
            if until is not None and time.monotonic() >= until:
                return

    def _read_frames(self) -> bool:
        """Read new bytes. Return True if nothing more can arrive."""
        is_over = self._process.poll() is not None  # checked first, because it may write and then end
        try:
            chunk = os.read(self._reading, _CHUNK)
        except BlockingIOError:
            return is_over
        self._bytes += chunk
        return not chunk

    def _whole_frames(self) -> Iterator[tuple[bytes, bytes]]:
        start, end = 0, len(self._bytes)
        while end - start >= HEADER.size and not self._is_garbled:
            letter, length = HEADER.unpack_from(self._bytes, start)
            next_start = start + HEADER.size + length
            if next_start > end:
                break
            yield letter, bytes(memoryview(self._bytes)[start + HEADER.size : next_start])
            start = next_start
        del self._bytes[:start]

    @property
    def _is_garbled(self) -> bool:
        """True if the next frame is longer than any of ours."""
        return len(self._bytes) >= HEADER.size and HEADER.unpack_from(self._bytes)[1] > LARGEST_FRAME

    def _read_output(self) -> list[tuple[bytes, bytes]]:
        """Return new output of both streams as messages."""
        found, now = [], time.monotonic()
        for descriptor, (stream, lines) in list(self._streams.items()):
            try:
                piece = os.read(descriptor, _CHUNK)
            except BlockingIOError:
                continue
            found += _messages(stream, lines.take(piece, now) if piece else lines.end())
            if not piece:
                self._poll.unregister(descriptor)
                del self._streams[descriptor]
        return found

    def _farewell(self) -> list[tuple[bytes, bytes]]:
        """Wait for its end, and return the remaining frames with the exit status."""
        found, until = [], time.monotonic() + _FAREWELL
        self._poll.unregister(self._reading)
        while not self._is_garbled and self._process.poll() is None and time.monotonic() < until:
            self._poll.poll(20)
            found += self._read_output()
        garbled, status = self._is_garbled, self._process.poll()
        self._kill()
        self._process.wait()
        found += self._read_output()
        for stream, lines in self._streams.values():
            found += _messages(stream, lines.end())
        text = GARBLED if garbled else _CLOSED_ITS_PIPE if status is None else ""
        found.append(_message(MessageKind.GONE, status=status, text=text))
        self.closed = True
        return found

    def _kill(self) -> None:
        with suppress(ProcessLookupError, PermissionError):
            if not self.closed:  # later its number may belong to another process
                os.killpg(self._process.pid, signal.SIGKILL)


def _script(request: ProgramRequest, descriptors: Mapping[str, int]) -> str:
    """Return the code for Python, without imports from the current folder."""
    said = {
        "path": str(request.path),
        "arguments": list(request.arguments),
        "seed": request.seed,
        "steps": request.steps,
        "table": request.table,
        "agent": request.agent,
        "scenario": request.scenario,
        "scenario_seed": request.seed if request.scenario_seed is None else request.scenario_seed,
        "episodes": request.episodes,
        "hyperparameters": dict(request.hyperparameters or {}),
        "defaults": dict(request.defaults or {}),
        "memory": request.memory,
        **descriptors,
    }
    return _SCRIPT.format(path=[each for each in sys.path if each], said=said)


def _pipe(reading: ExitStack, writing: ExitStack) -> tuple[int, int]:
    """Return the ends of a pipe, each closed with its stack, with the largest buffer."""
    ends = os.pipe()
    for end, closing in zip(ends, (reading, writing), strict=True):
        closing.callback(os.close, end)
    with suppress(ImportError, AttributeError, OSError):
        import fcntl  # not on Windows

        # on Linux; a small buffer would block a program between two frames
        fcntl.fcntl(ends[1], fcntl.F_SETPIPE_SZ, _CHUNK)
    return ends


def _memory_file(closing: ExitStack) -> int:
    """Return a descriptor of a memory page shared by two processes. On Linux neither can shrink it, which
    would crash the other.
    """
    if not hasattr(os, "memfd_create"):
        descriptor = closing.enter_context(tempfile.TemporaryFile()).fileno()  # noqa: SIM115
        os.ftruncate(descriptor, mmap.PAGESIZE)
        return descriptor
    import fcntl  # not on Windows

    descriptor = os.memfd_create("rl-tui", os.MFD_CLOEXEC | os.MFD_ALLOW_SEALING)
    closing.callback(os.close, descriptor)
    os.ftruncate(descriptor, mmap.PAGESIZE)
    seals = fcntl.F_SEAL_SHRINK | fcntl.F_SEAL_GROW | fcntl.F_SEAL_SEAL
    fcntl.fcntl(descriptor, fcntl.F_ADD_SEALS, seals)
    return descriptor


def _messages(stream: str, lines: Iterable[WrittenLine]) -> list[tuple[bytes, bytes]]:
    return [
        _message(MessageKind.OUTPUT, step=None, stream=stream, text=line.text, replaces=line.replaces)
        for line in lines
    ]


def _message(kind: str, **more: Any) -> tuple[bytes, bytes]:
    return OWN_MESSAGE, json.dumps({"kind": kind, **more}).encode()


# Watching to the end, without a screen


TIME_LIMIT: Final = "TimeLimit"
"""Type of the error of a program that took too long."""
_LOOK: Final = 0.1  # seconds
_AFTER_THE_END: Final = 3.0
"""Seconds that a program may continue after its steps or its end."""


def watched_to_the_end(
    request: ProgramRequest,
    on_progress: Callable[[ProgramLog], None] = lambda _: None,
    seconds: float | None = None,
    log: ProgramLog | None = None,
) -> ProgramLog:
    """Run the program of `request` to its end.

    Args:
        request: Program to run.
        on_progress: Called about ten times a second, and may raise to stop it.
        seconds: Time limit, if any.
        log: Receives its messages, default a new one.

    Returns:
        Everything it reported.

    Raises:
        OSError: The process cannot be started.
    """
    log, process = log or ProgramLog(), ProgramProcess(request)
    limit = math.inf if seconds is None else time.monotonic() + seconds
    farewell = math.inf
    try:
        while not (process.closed or log.is_garbled) and time.monotonic() < min(limit, farewell):
            for letter, payload in process.frames(_LOOK):
                log.take(letter, payload)
            on_progress(log)
            if farewell == math.inf and (log.ended or _has_taken(log, request.steps)):
                farewell = time.monotonic() + _AFTER_THE_END
    finally:
        process.end()
    if not (log.ended or _has_taken(log, request.steps)):
        file, line = log.stands_at or ("", None)
        log.error = ProgramError(TIME_LIMIT, f"the program was ended after {seconds:g} seconds", file, line)
    elif not log.ended and log.stands_at is not None:
        log.notes.append(f"after the last step the program stayed in line {log.stands_at[1]}, and was ended")
    return log


def _has_taken(log: ProgramLog, steps: int | None) -> bool:
    return steps is not None and log.recording.count >= steps
