"""A program in a pseudo-terminal."""

from __future__ import annotations

import fcntl
import os
import pty
import re
import select
import signal
import struct
import subprocess
import sys
import termios
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from types import TracebackType
from typing import Any, Final

from emulator import Emulator

DEADLINE: Final = 120.0  # seconds until text appears: only a broken program takes longer
RL_TUI: Final = (sys.executable, "-m", "rl_tui")

_SEQUENCE: Final = re.compile(
    rb"\x1b(?:\[[0-?]*[ -/]*[@-~]|[\]P_^][^\x07\x1b]*(?:\x07|\x1b\\)|[()*+][\x20-\x7e]|[=>78cDEHMZ])"
)
_MODE: Final = re.compile(rb"\x1b\[\?([0-9;]+)([hl])")
_ON_AT_FIRST: Final = {b"7", b"25"}  # line wrap, cursor
_NOT_INHERITED: Final = ("NO_COLOR", "COLORTERM", "TERM_PROGRAM", "TMUX", "STY")


class PseudoTerminal:
    """Starts ``command`` in a terminal of ``size`` (columns, rows).

    ``environment`` is added to this process's own; None removes a variable.
    """

    def __init__(
        self,
        command: Sequence[str],
        environment: Mapping[str, str | None] | None = None,
        size: tuple[int, int] = (120, 40),
        *,
        tells_position: bool = True,
        synchronises: bool = True,
    ) -> None:
        self._ours, self.theirs = pty.openpty()
        self._set_size(*size)
        self.attributes_before = termios.tcgetattr(self.theirs)
        self._alive, alive = os.pipe()  # only the program holds its other end, and closes it by ending
        self.written = b""
        self.emulator = Emulator(*size, self._send, tells_position=tells_position, synchronises=synchronises)
        self.started = time.perf_counter()
        self.process = subprocess.Popen(
            command,
            stdin=self.theirs,
            stdout=self.theirs,
            stderr=self.theirs,
            env=environment_with(environment or {}),
            pass_fds=(alive,),
            start_new_session=True,
        )
        os.close(alive)

    def __enter__(self) -> PseudoTerminal:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self.process.poll() is None:
            with suppress(ProcessLookupError):
                os.killpg(self.process.pid, signal.SIGKILL)  # with its child processes
        self.process.wait()
        for descriptor in (self._ours, self.theirs, self._alive):
            os.close(descriptor)

    def press(self, keys: str) -> None:
        self._send(keys)

    def blank(self) -> None:
        """Clear the screen. The program does not notice, and must be made to draw again."""
        self.emulator.erase_in_display(2)

    def resize(self, columns: int, rows: int) -> None:
        self._set_size(columns, rows)
        self.emulator.resize(rows, columns)
        self.process.send_signal(signal.SIGWINCH)

    @property
    def screen(self) -> str:
        return self.emulator.text

    def wait_for(self, pattern: str, seconds: float = DEADLINE) -> re.Match[str]:
        found: list[re.Match[str]] = []

        def find() -> bool:
            match = re.search(pattern, self.screen)
            found.extend([match] if match else [])
            return match is not None

        self.wait_until(find, seconds, pattern)
        return found[0]

    def wait_until(
        self, condition: Callable[[], bool], seconds: float = DEADLINE, what: str = "what was waited for"
    ) -> None:
        deadline = time.perf_counter() + seconds
        while not (self.emulator.is_whole and condition()):
            if not self.read_more(deadline):
                raise AssertionError(f"{what!r} did not appear; what stands there:\n{self.screen}")

    def wait_for_end(self, seconds: float = DEADLINE) -> int:
        deadline = time.perf_counter() + seconds
        while self.read_more(deadline):
            pass
        assert self.process.wait(max(0.0, deadline - time.perf_counter())) is not None
        return self.process.returncode

    def reading(self, seconds: float) -> Iterator[tuple[float, str]]:
        deadline = time.perf_counter() + seconds
        while self.read_more(deadline):
            if self.emulator.is_whole:
                yield time.perf_counter(), self.screen

    @property
    def attributes(self) -> list[Any]:
        return termios.tcgetattr(self.theirs)

    @property
    def modes_left_changed(self) -> set[str]:
        last = {
            number: letter == b"h"
            for numbers, letter in _MODE.findall(self.written)
            for number in numbers.split(b";")
        }
        return {number.decode() for number, on in last.items() if on is not (number in _ON_AT_FIRST)}

    def _set_size(self, columns: int, rows: int) -> None:
        fcntl.ioctl(self.theirs, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))

    def _send(self, text: str) -> None:
        os.write(self._ours, text.encode())

    def read_more(self, deadline: float) -> bool:
        """Return False at the deadline, or at the end of the output."""
        left = max(0.0, deadline - time.perf_counter())
        ready, _, _ = select.select([self._ours, self._alive], [], [], left)
        if self._ours in ready:
            piece = os.read(self._ours, 65536)
            self.written += piece
            self.emulator.feed(piece)
            return True
        return False


def visible(written: bytes) -> str:
    return _SEQUENCE.sub(b"", written).decode("utf-8", errors="replace")


def environment_with(changes: Mapping[str, str | None]) -> dict[str, str]:
    kept = {
        name: value
        for name, value in os.environ.items()
        if not name.startswith("TEXTUAL") and name not in _NOT_INHERITED
    }
    wanted = {**kept, "TERM": "xterm-256color", "LC_ALL": "C.UTF-8", **changes}
    return {name: value for name, value in wanted.items() if value is not None}
