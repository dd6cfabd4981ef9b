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
"""Characters of a line that are kept."""
MOST_A_SECOND: Final = 300
"""Lines of one second that are kept; of the others only the last ones."""
LAST_KEPT: Final = 20
"""How many of the last ones are kept where there are more."""

_LONGEST_RAW: Final = 4 * LONGEST_LINE  # bytes: a character has at most so many
# What moves a cursor or sets colours: CSI and OSC sequences, and others of two characters
_ESCAPES: Final = re.compile(r"\x1b(?:\[[0-?]*[ -/]*[@-~]|\][^\x07\x1b]*(?:\x07|\x1b\\)?|[@-Z\\-_])")


class WrittenLine(NamedTuple):
    """One line; one that it ``replaces`` was its beginning, or an earlier state of it."""

    text: str
    replaces: bool


class WrittenLines:
    """The lines of one stream, put together from pieces of any size, in bounded memory.

    A carriage return begins its line anew, as progress bars do it. A line without an end is told as it
    is, and again as it goes on.
    """

    def __init__(self) -> None:
        self._rest = b""
        self._is_begun = False  # the beginning of the line that has no end yet
        self._second = -1
        self._room = MOST_A_SECOND
        self._left_out = 0
        self._last: deque[bytes] = deque(maxlen=LAST_KEPT)

    def take(self, piece: bytes, now: float) -> Iterator[WrittenLine]:
        """Yield the lines that are known with ``piece``, which came at ``now``, in seconds on any clock."""
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
        """Yield what is left when nothing more will come."""
        yield from self._catch_up()
        if self._rest.strip() and not self._is_begun:
            yield self._written(self._rest)

    def _without_flood(self, text: bytes) -> bytes:
        """Count the whole lines of ``text``, keep the last ones, and return the one without an end."""
        *flood, rest = text.rsplit(b"\n", LAST_KEPT + 1)
        if flood:
            self._left_out += text.count(b"\n")
            self._last.extend(flood[-LAST_KEPT:])
            self._is_begun = False
        return rest

    def _catch_up(self) -> Iterator[WrittenLine]:
        """Yield how many lines were left out, and the last ones of them."""
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
    """Return as much of a line without an end as its text needs, and what tells that it was longer."""
    if len(line) > _LONGEST_RAW:
        line = line[line.rfind(b"\r", 0, len(line) - 1) + 1 :]
    return line[: _LONGEST_RAW + 1]


def _text_of(line: bytes) -> str:
    """Return what a terminal would show of ``line``, as harmless characters."""
    line = line.rstrip(b"\r")
    shown = line[line.rfind(b"\r") + 1 :][: _LONGEST_RAW + 1].decode("utf-8", "replace")
    text = printable(_ESCAPES.sub("", shown).expandtabs(8)).rstrip()
    return text if len(text) <= LONGEST_LINE else text[: LONGEST_LINE - 1] + "…"


# The process


_CHUNK: Final = 1 << 20
_LOOK_AGAIN: Final = 0.5  # seconds, after which a process is asked whether it still lives
_BEHIND_OUTPUT: Final = 10  # milliseconds, in which a step comes that was taken before something was written
_FAREWELL: Final = 1.0  # seconds that a process may take to end once its pipe is closed
_CLOSED_ITS_PIPE: Final = "the program closed the pipe by which it was watched, and was ended"
_ENVIRONMENT: Final = {"PYTHONHASHSEED": "0", "MPLBACKEND": "Agg", "SDL_VIDEODRIVER": "dummy"}
# ascii, since what stands in a command line is written in the encoding of the system
_SCRIPT: Final = """\
import sys
sys.path[:] = {path!a}
from rl_tui.programs.watched.child.main import main
main({said!a})
"""


@dataclass(frozen=True, slots=True)
class ProgramRequest:
    """What to run: a script, or an agent without a loop.

    ``agent`` is the class or function in ``path`` that is an agent (empty: the only one), None where ``path``
    is a script with a loop of its own. An agent learns in ``scenario``, an id or a path, for ``episodes``.
    What is random about that world is drawn from ``scenario_seed``, from ``seed`` if that is None.
    ``hyperparameters`` are given to its constructor by name, ``defaults`` where it has no default itself.
    ``steps`` ends the program after so many, ``memory`` is how many bytes it may ask the system for.
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
    """The process of ``request``, in a session of its own, which ends with :meth:`end`.

    It may take ``allowed`` steps at first. It ends with this process too, however that ends, and all that it
    started in its session. Raises OSError where no process can be started.
    """

    def __init__(self, request: ProgramRequest, allowed: int = NO_LIMIT) -> None:
        if not hasattr(select, "poll"):
            raise OSError("programs can be watched on Linux and macOS only")
        if not sys.executable:
            raise FileNotFoundError("which Python this is is not known")
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
        """Let it take steps until it has taken ``steps`` in all; 0 holds it at its next step.

        ``what`` else it is told, if anything, it hears before it takes the next one.
        """
        if not self.closed:
            self._allowed[0] = steps
            self.ask(what or {})

    def ask(self, what: Mapping[str, Any]) -> None:
        """Tell it something, which it hears when it waits. This never waits itself."""
        if not self.closed:
            self.asked += 1
            self._unsent += json.dumps({"number": self.asked, **what}).encode() + b"\n"
            self._send()

    def frames(self, seconds: float | None = 0.0) -> Iterator[tuple[bytes, bytes]]:
        """Return what has come, waiting for at most ``seconds`` (None: for as long as it takes).

        What the program wrote on stdout and stderr is among it, behind the steps that it took meanwhile. The
        last of all is a message of its end.
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
        """End it and all that it started."""
        self._kill()
        self._process.wait()
        self._to_close.close()
        self.closed = True

    def _listen(self, stdout: int, stderr: int) -> None:
        """Prepare to read its pipes, and to write into its own, without ever waiting for it."""
        os.set_blocking(self._asking, False)
        self._unsent = b""
        self.asked = 0
        """How many lines it was told so far."""
        self._bytes = bytearray()
        self._streams = {stdout: ("out", WrittenLines()), stderr: ("err", WrittenLines())}
        self._poll, self._poll_steps = select.poll(), select.poll()
        self._poll_steps.register(self._reading, select.POLLIN)
        for descriptor in (self._reading, *self._streams):
            os.set_blocking(descriptor, False)
            self._poll.register(descriptor, select.POLLIN)
        self.closed = False
        """Whether it is over: nothing more will come."""

    @property
    def exit_status(self) -> int | None:
        """How it ended, None while it has not."""
        return self._process.poll()

    def _send(self) -> None:
        with suppress(OSError):  # it is over, or its pipe is full
            while self._unsent:
                self._unsent = self._unsent[os.write(self._asking, self._unsent) :]

    def _wait(self, seconds: float | None) -> None:
        """Wait until there is something to read, or the process is over.

        A child of the program may keep its pipe open then, so that this is looked at now and then.
        """
        until = None if seconds is None else time.monotonic() + seconds
        while True:
            left = _LOOK_AGAIN if until is None else min(_LOOK_AGAIN, until - time.monotonic())
            ready = self._poll.poll(max(0.0, left) * 1000)
            if ready and all(descriptor != self._reading for descriptor, _ in ready):
                self._poll_steps.poll(_BEHIND_OUTPUT)  # of the step that it belongs to
            if ready or self._process.poll() is not None:
                return
            if until is not None and time.monotonic() >= until:
                return

    def _read_frames(self) -> bool:
        """Take in what has come from the watched side; return whether nothing more can."""
        is_over = self._process.poll() is not None  # looked at first: it may write, and then end
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
        """Whether what comes next is longer than any frame of ours."""
        return len(self._bytes) >= HEADER.size and HEADER.unpack_from(self._bytes)[1] > LARGEST_FRAME

    def _read_output(self) -> list[tuple[bytes, bytes]]:
        """Return what has come on both streams, as messages."""
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
        """See it to its end, and return what it left behind, and how it ended."""
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
            if not self.closed:  # later its number may be that of others
                os.killpg(self._process.pid, signal.SIGKILL)


def _script(request: ProgramRequest, descriptors: Mapping[str, int]) -> str:
    """Return what Python runs; the current folder is no place to import from."""
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
    """Return the ends of a pipe, each of which is closed with a stack, as large as it may be."""
    ends = os.pipe()
    for end, closing in zip(ends, (reading, writing), strict=True):
        closing.callback(os.close, end)
    with suppress(ImportError, AttributeError, OSError):
        import fcntl  # not on Windows

        # on Linux; a small one holds a program up between two frames
        fcntl.fcntl(ends[1], fcntl.F_SETPIPE_SZ, _CHUNK)
    return ends


def _memory_file(closing: ExitStack) -> int:
    """Return a descriptor of a page of memory that two processes can share.

    On Linux neither can make it smaller, which would end the other as soon as it reads there.
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
"""The type of the error of a program that took too long."""
_LOOK: Final = 0.1  # seconds
_AFTER_THE_END: Final = 3.0
"""Seconds that a program may go on once its steps are taken, or it has said that it is over."""


def watched_to_the_end(
    request: ProgramRequest,
    on_progress: Callable[[ProgramLog], None] = lambda _: None,
    seconds: float | None = None,
    log: ProgramLog | None = None,
) -> ProgramLog:
    """Return all that the program of ``request`` told until it ended, or ``seconds`` were over.

    ``on_progress`` is called about ten times a second, or oftener, and may raise to end it. ``log`` is what
    takes it in, if that is at hand. Raises OSError where no process can be started.
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
