"""Output to the terminal, which never blocks the program."""

from __future__ import annotations

import os
import select
import threading
from collections import deque
from collections.abc import Callable
from time import monotonic
from typing import Final

_AT_ONCE: Final = 4096  # bytes: joins small pieces; larger ones go alone
_SLICE: Final = 2048  # bytes: a terminal takes all or nothing, and a slow one needs time
_PATIENCE: Final = 1.0  # seconds without progress until a farewell is given up


class TerminalWriter:
    """A thread that writes to a terminal's file descriptor.

    It calls ``on_lost`` once when writing has become impossible.
    """

    def __init__(self, fileno: int, on_lost: Callable[[], None]) -> None:
        self.fileno = fileno
        """The descriptor of the terminal."""
        self._on_lost = on_lost
        self._changed = threading.Condition()  # guards everything below
        self._pieces: deque[bytes] = deque()
        self.waiting = 0
        """Bytes that the system has not taken yet."""
        self._leaving = 0  # part of ``waiting`` that the thread has taken
        self._closing = False
        self._lost = False
        self._thread = threading.Thread(target=self._live, name="terminal-output", daemon=True)
        self._thread.start()

    def write(self, data: bytes) -> None:
        """Queue ``data`` without waiting."""
        with self._changed:
            if data and not self._lost:
                self._pieces.append(data)
                self.waiting += len(data)
                self._changed.notify_all()

    def forget(self) -> None:
        """Drop waiting bytes, except those that have started to leave."""
        with self._changed:
            self._pieces.clear()
            self.waiting = self._leaving
            self._changed.notify_all()

    def drain(self, seconds: float) -> bool:
        """Wait up to ``seconds``, and return whether all are written."""
        deadline = monotonic() + seconds
        before = -1
        with self._changed:
            while self.waiting and not self._lost:
                patience = min(_PATIENCE, deadline - monotonic())
                if self.waiting == before or patience <= 0.0:
                    return False
                before = self.waiting
                self._changed.wait(patience)
            return not self._lost

    def close(self, seconds: float) -> None:
        """Write for ``seconds``, then end the thread if possible."""
        drained = self.drain(seconds)
        with self._changed:
            self._closing = True
            self._changed.notify_all()
        if drained:
            self._thread.join()

    # The thread

    def _live(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: bool(self._pieces) or self._closing)
                data = self._take()
            if not data:
                return
            try:
                self._write_out(data)
            except OSError:
                with self._changed:
                    self._pieces.clear()
                    self.waiting, self._lost = 0, True
                    self._changed.notify_all()
                self._on_lost()
                return

    def _take(self) -> bytes:
        taken: list[bytes] = []
        while self._pieces and (not taken or self._leaving + len(self._pieces[0]) <= _AT_ONCE):
            taken.append(self._pieces.popleft())
            self._leaving += len(taken[-1])
        return b"".join(taken)

    def _write_out(self, data: bytes) -> None:
        left = memoryview(data)
        while left:
            try:
                written = os.write(self.fileno, left[:_SLICE])
            except BlockingIOError:  # another program that shares the terminal has made it non-blocking
                select.select([], [self.fileno], [])
                continue
            left = left[written:]
            with self._changed:
                self._leaving -= written
                self.waiting -= written
                self._changed.notify_all()
