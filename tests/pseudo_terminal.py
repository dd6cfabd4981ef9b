"""A program in a pseudo-terminal: press keys, wait for what appears, see how the terminal was left."""

from __future__ import annotations

import fcntl
import os
import pty
import re
import select
import struct
import subprocess
import sys
import termios
import time
from collections.abc import Iterator, Mapping, Sequence
from types import TracebackType
from typing import Any, Final

DEADLINE: Final = 120.0  # seconds for something to appear; a broken program is told by it, not a slow machine
RL_TUI: Final = (sys.executable, "-m", "rl_tui.cli")

_SEQUENCE: Final = re.compile(
    rb"\x1b(?:\[[0-?]*[ -/]*[@-~]|[\]P_^][^\x07\x1b]*(?:\x07|\x1b\\)|[()*+][\x20-\x7e]|[=>78cDEHMZ])"
)
_MODE: Final = re.compile(rb"\x1b\[\?([0-9;]+)([hl])")
_ON_AT_FIRST: Final = {b"7", b"25"}  # line wrap, cursor


class PseudoTerminal:
    """Starts ``command`` in a terminal of ``size`` (columns, rows) and watches what it writes."""

    def __init__(
        self,
        command: Sequence[str],
        environment: Mapping[str, str] | None = None,
        size: tuple[int, int] = (120, 40),
    ) -> None:
        self._ours, self._theirs = pty.openpty()
        fcntl.ioctl(self._theirs, termios.TIOCSWINSZ, struct.pack("HHHH", size[1], size[0], 0, 0))
        self.attributes_before = termios.tcgetattr(self._theirs)
        self._alive, alive = os.pipe()  # its other end is only held by the program, and closed when that ends
        kept = {
            name: value
            for name, value in os.environ.items()
            if not name.startswith("TEXTUAL") and name not in ("NO_COLOR", "COLORTERM")
        }
        self.started = time.perf_counter()
        self.process = subprocess.Popen(
            command,
            stdin=self._theirs,
            stdout=self._theirs,
            stderr=self._theirs,
            env={**kept, "TERM": "xterm-256color", "LC_ALL": "C.UTF-8", **(environment or {})},
            pass_fds=(alive,),
            start_new_session=True,
        )
        os.close(alive)
        self.written = b""
        self._seen = 0

    def __enter__(self) -> PseudoTerminal:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self.process.poll() is None:
            self.process.kill()
        self.process.wait()
        for descriptor in (self._ours, self._theirs, self._alive):
            os.close(descriptor)

    def press(self, keys: str) -> None:
        """Type ``keys``; what is waited for from now on must be written from now on."""
        self._seen = len(self.written)
        os.write(self._ours, keys.encode())

    def wait_for(self, pattern: str, seconds: float = DEADLINE) -> re.Match[str]:
        """Read until ``pattern`` is found in the text written since the last key, or fail."""
        deadline = time.perf_counter() + seconds
        while True:
            text = visible(self.written[self._seen :])
            if match := re.search(pattern, text):
                return match
            if not self._read(deadline):
                raise AssertionError(f"{pattern!r} did not appear; the end of what did:\n{text[-3000:]}")

    def wait_for_end(self, seconds: float = DEADLINE) -> int:
        """Read until the program has ended, and return its exit status."""
        deadline = time.perf_counter() + seconds
        while self._read(deadline):
            pass
        assert self.process.wait(max(0.0, deadline - time.perf_counter())) is not None
        return self.process.returncode

    def reading(self, seconds: float) -> Iterator[tuple[float, str]]:
        """Read for so long; yield each piece of text as it comes, with the moment."""
        deadline = time.perf_counter() + seconds
        read = len(self.written)
        while self._read(deadline):
            yield time.perf_counter(), visible(self.written[read:])
            read = len(self.written)

    @property
    def attributes(self) -> list[Any]:
        """How the terminal is set now, as termios has it."""
        return termios.tcgetattr(self._theirs)

    @property
    def modes_left_changed(self) -> set[str]:
        """The private modes that are not as they were before the program started."""
        last = {
            number: letter == b"h"
            for numbers, letter in _MODE.findall(self.written)
            for number in numbers.split(b";")
        }
        return {number.decode() for number, on in last.items() if on is not (number in _ON_AT_FIRST)}

    def _read(self, deadline: float) -> bool:
        """Read what there is, waiting for it; False at the deadline, or when an ended program is all read."""
        left = max(0.0, deadline - time.perf_counter())
        ready, _, _ = select.select([self._ours, self._alive], [], [], left)
        if self._ours in ready:
            self.written += os.read(self._ours, 65536)
            return True
        return False


def visible(written: bytes) -> str:
    """Return what was written without the sequences that steer the terminal."""
    return _SEQUENCE.sub(b"", written).decode("utf-8", errors="replace")
