"""The connection of a watched program to the watching process."""

from __future__ import annotations

import json
import mmap
import os
import select
import struct
import sys
from collections.abc import Callable
from threading import RLock
from time import monotonic
from typing import Any, Final, NoReturn

import numpy as np
import numpy.typing as npt

from rl_tui.programs.watched.messages import (
    CHANGE_WIDTH,
    HEADER,
    MESSAGE,
    STEP_WIDTH,
    STEPS,
    TABLE,
    MessageKind,
)

# Reports through the pipe


_BETWEEN_BATCHES: Final = 1 / 30  # seconds
_MOST_NUMBERS: Final = 1_000_000  # of waiting changes


class Channel:
    """Writes to the pipe `reports`.

    The program only appends to `steps` and `changes`, so another thread may flush them. The process ends at
    once if nobody reads. A forked process writes nothing.
    """

    def __init__(self, reports: int) -> None:
        self._reports, self._process = reports, os.getpid()
        self.leave: Callable[[int], NoReturn] = os._exit
        """Ends the process at once. A script replaces it by its own function."""
        self._due, self._written = 0.0, 0
        self._writing = RLock()
        if sys.platform != "win32":
            os.register_at_fork(after_in_child=self._unlock)
        self._noted: set[str] = set()
        self.steps: list[float] = []
        self.changes: list[float] = []

    def message(self, kind: str, **more: Any) -> None:
        """Write a message after all earlier steps."""
        with self._writing:
            self.flush()
            self._write(MESSAGE, json.dumps({"kind": kind, **more}).encode())

    def note(self, text: str) -> None:
        """Report a workaround or an unknown fact, once."""
        if text not in self._noted:
            self._noted.add(text)
            self.message(MessageKind.NOTE, text=text)

    def table(self, values: npt.NDArray[np.float64]) -> None:
        """Write a table, `[S·A]`, after its message."""
        with self._writing:
            self._write(TABLE, np.ascontiguousarray(values, np.float64).tobytes())

    @property
    def is_due(self) -> bool:
        """True about thirty times a second, or when there is much to write."""
        return monotonic() >= self._due or len(self.changes) > _MOST_NUMBERS

    @property
    def is_late(self) -> bool:
        """True if something has waited too long."""
        return bool(self.steps or self.changes) and monotonic() >= self._due + _BETWEEN_BATCHES

    def flush(self, *, but_last: bool = False) -> None:
        """Write steps and changes, `but_last` without those of the last step, which may get more changes."""
        with self._writing:
            changes = len(self.changes)  # counted first, because a change must not precede its step
            steps = len(self.steps)
            if but_last:
                steps = max(steps - STEP_WIDTH, 0)
                end = self._written + steps // STEP_WIDTH
                while changes and self.changes[changes - CHANGE_WIDTH] >= end:
                    changes -= CHANGE_WIDTH
            if steps or changes:
                numbers = (steps // STEP_WIDTH, *self.steps[:steps], *self.changes[:changes])
                payload = struct.pack(f"{len(numbers)}d", *numbers)
                del self.steps[:steps]
                del self.changes[:changes]
                self._written += steps // STEP_WIDTH
                self._write(STEPS, payload)
            self._due = monotonic() + _BETWEEN_BATCHES

    def from_a_fork(self, kind: str, **more: Any) -> None:
        """Write a message from a forked process, short enough for one piece."""
        payload = json.dumps({"kind": kind, **more}).encode()
        os.write(self._reports, HEADER.pack(MESSAGE, len(payload)) + payload)

    def _unlock(self) -> None:
        """Give a forked process its own lock, because the holder does not exist there."""
        self._writing = RLock()

    def _write(self, letter: bytes, payload: bytes) -> None:
        if os.getpid() != self._process:
            return
        left = memoryview(HEADER.pack(letter, len(payload)) + payload)
        try:
            while left:
                left = left[os.write(self._reports, left) :]
        except OSError:
            self.leave(0)


# Waiting for permission


_AT_ONCE: Final = 65_536  # bytes


class Gate:
    """Lets the program run as far as allowed, and handles requests."""

    def __init__(self, channel: Channel, asked: int, shared: int) -> None:
        self._channel, self._asked = channel, asked
        self.allowed = memoryview(mmap.mmap(shared, mmap.PAGESIZE)).cast("q")
        """The number of allowed steps, in one element."""
        self.on_asked: dict[str, Callable[[Any], None]] = {}
        self._unread = b""
        self._heard = 0
        self._is_held = False
        self.is_waiting = False
        """True while the program waits for permission."""

    def wait(self, count: int, met: str | None) -> None:
        """Wait until more than `count` steps are allowed, and for a new "stop" after an event `met`.

        The process ends if nobody watches any more.
        """
        self._is_held = met is not None
        self.is_waiting = True
        while self._is_held or count >= self.allowed[0]:
            stopped = met if self._is_held else None
            self._channel.message(MessageKind.WAITING, step=count, stopped=stopped, heard=self._heard)
            self._hear()
        self.is_waiting = False
        self.listen()  # earlier requests apply from the next step on

    def listen(self) -> None:
        """Handle pending requests."""
        if select.select([self._asked], [], [], 0)[0]:
            self._hear()

    def _hear(self) -> None:
        heard = os.read(self._asked, _AT_ONCE)
        if not heard:
            self._channel.leave(0)
        *lines, self._unread = (self._unread + heard).split(b"\n")
        for line in lines:
            said = json.loads(line)
            self._heard = said["number"]
            self._is_held = self._is_held and "stop" not in said
            for key, value in said.items():
                if key in self.on_asked:
                    self.on_asked[key](value)
