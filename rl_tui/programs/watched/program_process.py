"""The process of a watched program, from outside."""

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
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Final, NamedTuple

from rl_tui.common.errors import UserError
from rl_tui.common.findings import printable
from rl_tui.programs.watched.messages import HEADER, LARGEST_FRAME, NO_LIMIT, OWN_MESSAGE, MessageKind
from rl_tui.programs.watched.notebook import place_in_words
from rl_tui.programs.watched.program_log import GARBLED, ProgramError, ProgramLog

# Output, cut into lines


LONGEST_LINE: Final = 500
MOST_A_SECOND: Final = 300
"""Most lines per second. Of more, only the last ones are kept."""
LAST_KEPT: Final = 20

_LONGEST_RAW: Final = 4 * LONGEST_LINE  # bytes; a character has at most four
# cursor and colour sequences: CSI, OSC, and others of two characters
_ESCAPES: Final = re.compile(r"\x1b(?:\[[0-?]*[ -/]*[@-~]|\][^\x07\x1b]*(?:\x07|\x1b\\)?|[@-Z\\-_])")


class _WrittenLine(NamedTuple):
    text: str
    replaces: bool


class WrittenLines:
    """The lines of a stream, made of pieces of any size in bounded memory.

    A carriage return restarts a line, as in progress bars. An unfinished line is reported again as it grows.
    """

    def __init__(self) -> None:
        self._rest = b""
        self._is_begun = False  # of the unfinished line
        self._second = -1
        self._room = MOST_A_SECOND
        self._left_out = 0
        self._last: deque[bytes] = deque(maxlen=LAST_KEPT)

    def take(self, piece: bytes, now: float) -> Iterator[_WrittenLine]:
        """Yield the lines after `piece`, which arrived at `now` (seconds on any clock)."""
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
            yield _WrittenLine(text, replaces)

    def end(self) -> Iterator[_WrittenLine]:
        """Yield the remaining lines."""
        yield from self._catch_up()
        if self._rest.strip() and not self._is_begun:
            yield self._written(self._rest)

    def _without_flood(self, text: bytes) -> bytes:
        *flood, rest = text.rsplit(b"\n", LAST_KEPT + 1)
        if flood:
            self._left_out += text.count(b"\n")
            self._last.extend(flood[-LAST_KEPT:])
            self._is_begun = False
        return rest

    def _catch_up(self) -> Iterator[_WrittenLine]:
        left_out = self._left_out - len(self._last)
        if left_out > 0:
            yield _WrittenLine(f"… {left_out:,} lines left out", False)
        for line in self._last:
            yield _WrittenLine(_text_of(line), False)
        self._last.clear()
        self._left_out = 0

    def _written(self, line: bytes) -> _WrittenLine:
        replaces, self._is_begun = self._is_begun, False
        return _WrittenLine(_text_of(line), replaces)


def _shortened(line: bytes) -> bytes:
    if len(line) > _LONGEST_RAW:
        line = line[line.rfind(b"\r", 0, len(line) - 1) + 1 :]
    return line[: _LONGEST_RAW + 1]


def _text_of(line: bytes) -> str:
    line = line.rstrip(b"\r")
    shown = line[line.rfind(b"\r") + 1 :][: _LONGEST_RAW + 1].decode("utf-8", "replace")
    text = printable(_ESCAPES.sub("", shown).expandtabs(8)).rstrip()
    return text if len(text) <= LONGEST_LINE else text[: LONGEST_LINE - 1] + "…"


# The process


_CHUNK: Final = 1 << 20
_LOOK_AGAIN: Final = 0.5  # seconds between checks that the process lives
_BEHIND_OUTPUT: Final = 10  # milliseconds in which an earlier step arrives after output
_FAREWELL: Final = 1.0  # seconds that a process may take to end after its pipe is closed
_CLOSED_ITS_PIPE: Final = "the program closed the pipe to rl-tui, and was stopped"
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
        seed: Seed of all generators.
        steps: Limit of steps, if any.
        table: Name of the table, if given by the user.
        agent: Class or function of an agent ("" for the only one), or None for a script.
        scenario: Id or path, for an agent.
        scenario_seed: Seed of the world, default `seed`.
        hyperparameters: Numbers from the user by name.
        defaults: Numbers for parameters without a default.
        memory: Limit in bytes, if any.
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
    hyperparameters: Mapping[str, float] = field(default_factory=dict)
    defaults: Mapping[str, float] = field(default_factory=dict)
    memory: int | None = None


def refuse_without_posix() -> None:
    """Raise UserError on Windows, which cannot stop a program."""
    if sys.platform == "win32":
        raise UserError("your own programs run on Linux and macOS only; on Windows, use WSL")


class ProgramProcess:
    """The process of `request` in its own session, until `end`. Raises OSError if it cannot be started.

    It may take `allowed` steps at first. It ends with this process, together with everything it started.
    """

    def __init__(self, request: ProgramRequest, allowed: int = NO_LIMIT) -> None:
        refuse_without_posix()
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
        """Allow `steps` in all, 0 to stop at the next one. It reads `what` before that."""
        if not self.closed:
            self._allowed[0] = steps
            self.ask(what or {})

    def ask(self, what: Mapping[str, Any]) -> None:
        """Send a request without blocking."""
        if not self.closed:
            self.asked += 1
            self._unsent += json.dumps({"number": self.asked, **what}).encode() + b"\n"
            self._send()

    def frames(self, seconds: float | None = 0.0) -> list[tuple[bytes, bytes]]:
        """Return new frames, waiting up to `seconds` (None for no limit).

        Output comes after the steps taken before it, and a message about the end comes last.
        """
        if self.closed:
            return []
        if self._unsent:
            self._send()
        self._wait(seconds)
        over = self._process.poll() is not None  # checked first, because it may write and then end
        with suppress(BlockingIOError):
            chunk = os.read(self._reading, _CHUNK)
            self._bytes += chunk
            over = not chunk
        found = self._whole_frames() + self._read_output()
        if over or self._is_garbled:
            found += self._farewell()
        return found

    def end(self) -> None:
        """Kill it and everything that it started."""
        self._kill()
        self._process.wait()
        self._to_close.close()
        self.closed = True

    def _listen(self, stdout: int, stderr: int) -> None:
        self._unsent = b""
        self.asked = 0
        """Number of requests so far."""
        self._bytes = bytearray()
        self._is_garbled = False  # the next frame is longer than any of ours
        self._streams = {stdout: ("out", WrittenLines()), stderr: ("err", WrittenLines())}
        if sys.platform != "win32":
            for descriptor in (self._asking, self._reading, *self._streams):
                os.set_blocking(descriptor, False)
        self._poll_steps, self._poll = _poll(self._reading), _poll(self._reading, *self._streams)
        self.closed = False
        """True once nothing more will arrive."""

    @property
    def exit_status(self) -> int | None:
        """Exit status, if it has ended."""
        return self._process.poll()

    def _send(self) -> None:
        with suppress(OSError):  # it has ended, or its pipe is full
            while self._unsent:
                self._unsent = self._unsent[os.write(self._asking, self._unsent) :]

    def _wait(self, seconds: float | None) -> None:
        """Wait for output or the end. Look regularly, because a child may keep the pipe open."""
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

    def _whole_frames(self) -> list[tuple[bytes, bytes]]:
        found, start, end = [], 0, len(self._bytes)
        while end - start >= HEADER.size and not self._is_garbled:
            letter, length = HEADER.unpack_from(self._bytes, start)
            content, next_start = start + HEADER.size, start + HEADER.size + length
            self._is_garbled = length > LARGEST_FRAME
            if next_start > end:
                break
            found.append((letter, bytes(memoryview(self._bytes)[content:next_start])))
            start = next_start
        del self._bytes[:start]
        return found

    def _read_output(self) -> list[tuple[bytes, bytes]]:
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
            if sys.platform != "win32" and not self.closed:  # later its number may belong to another process
                os.killpg(self._process.pid, signal.SIGKILL)


def _script(request: ProgramRequest, descriptors: Mapping[str, int]) -> str:
    said = {**asdict(request), "path": str(request.path), **descriptors}
    if request.scenario_seed is None:
        said["scenario_seed"] = request.seed
    return _SCRIPT.format(path=[each for each in sys.path if each], said=said)


def _pipe(reading: ExitStack, writing: ExitStack) -> tuple[int, int]:
    ends = os.pipe()
    for end, closing in zip(ends, (reading, writing), strict=True):
        closing.callback(os.close, end)
    if sys.platform == "linux":
        import fcntl

        with suppress(OSError):  # a small buffer would block a program between two frames
            fcntl.fcntl(ends[1], fcntl.F_SETPIPE_SZ, _CHUNK)
    return ends


def _poll(*descriptors: int) -> Any:
    if sys.platform == "win32":
        raise NotImplementedError
    poll = select.poll()
    for descriptor in descriptors:
        poll.register(descriptor, select.POLLIN)
    return poll


def _memory_file(closing: ExitStack) -> int:
    """Return a shared memory page. On Linux neither process can shrink it, which would crash the other."""
    if sys.platform != "linux" or not hasattr(os, "memfd_create"):  # Python may be built for an old glibc
        descriptor = closing.enter_context(tempfile.TemporaryFile()).fileno()  # noqa: SIM115
        os.ftruncate(descriptor, mmap.PAGESIZE)
        return descriptor
    import fcntl

    descriptor = os.memfd_create("rl-tui", os.MFD_CLOEXEC | os.MFD_ALLOW_SEALING)
    closing.callback(os.close, descriptor)
    os.ftruncate(descriptor, mmap.PAGESIZE)
    seals = fcntl.F_SEAL_SHRINK | fcntl.F_SEAL_GROW | fcntl.F_SEAL_SEAL
    fcntl.fcntl(descriptor, fcntl.F_ADD_SEALS, seals)
    return descriptor


def _messages(stream: str, lines: Iterable[_WrittenLine]) -> list[tuple[bytes, bytes]]:
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
    """Run a program to its end, and return everything it reported. Raises OSError if it cannot be started.

    Args:
        request: Program to run.
        on_progress: Called about ten times a second, and may raise to stop it.
        seconds: Time limit, if any.
        log: Receives its messages, default a new one.
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
        log.error = ProgramError(TIME_LIMIT, f"the program was stopped after {seconds:g} seconds", file, line)
    elif not log.ended and log.stands_at is not None:
        log.notes.append(
            f"after its last step the program did not leave {place_in_words(*log.stands_at)}, and was stopped"
        )
    return log


def _has_taken(log: ProgramLog, steps: int | None) -> bool:
    return steps is not None and log.recording.count >= steps
