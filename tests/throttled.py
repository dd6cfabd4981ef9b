"""A pseudo-terminal at the end of a slow link."""

from __future__ import annotations

import os
import select
import time
from collections.abc import Mapping, Sequence
from typing import Any

from pseudo_terminal import PseudoTerminal

_PIECE = 0.01  # seconds: bytes within this time arrive together


class ThrottledTerminal(PseudoTerminal):
    """Passes ``rate`` bytes a second, or everything at once if it is None.

    A buffer of ``room`` bytes, in addition to the kernel's, lies between the program and the link, as with
    SSH.
    """

    def __init__(
        self,
        command: Sequence[str],
        environment: Mapping[str, str | None] | None = None,
        size: tuple[int, int] = (80, 24),
        *,
        rate: float | None = None,
        room: int = 0,
        **terminal: Any,
    ) -> None:
        super().__init__(command, environment, size, **terminal)
        self.rate = rate
        self._room = room
        self._waiting = b""
        self._free_at = time.perf_counter()  # the time when the link has carried all its input

    def read_more(self, deadline: float) -> bool:
        if self.rate is None and not self._waiting:
            return super().read_more(deadline)
        while True:
            now = time.perf_counter()
            self._fill(now)
            if self._waiting and now >= self._free_at:
                count = len(self._waiting) if self.rate is None else max(1, int(self.rate * _PIECE))
                piece, self._waiting = self._waiting[:count], self._waiting[count:]
                if self.rate is not None:
                    self._free_at = max(self._free_at, now - _PIECE) + len(piece) / self.rate
                self.written += piece
                self.emulator.feed(piece)
                return True
            if now >= deadline:
                return False
            until = min(deadline, self._free_at) if self._waiting else deadline
            watched = [self._alive] if self._is_full() else [self._ours, self._alive]
            ready, _, _ = select.select(watched, [], [], max(0.0, until - now))
            if ready == [self._alive]:
                if not self._waiting:
                    return False
                time.sleep(max(0.0, self._free_at - time.perf_counter()))  # the rest is still on its way

    def _is_full(self) -> bool:
        return len(self._waiting) >= max(self._room, int((self.rate or 65536) * _PIECE))

    def _fill(self, now: float) -> None:
        while not self._is_full() and select.select([self._ours], [], [], 0.0)[0]:
            if not self._waiting:
                self._free_at = max(self._free_at, now - _PIECE)
            room = max(self._room, int((self.rate or 65536) * _PIECE)) - len(self._waiting)
            self._waiting += os.read(self._ours, min(room, 65536))
