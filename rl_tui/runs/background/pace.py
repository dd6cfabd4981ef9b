"""Progress of a background computation."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable
from typing import Final

from rl_tui.common.words import lasting

PATIENCE: Final = 5.0
"""Seconds without progress before a busy machine is reported."""
MACHINE_IS_BUSY: Final = "the machine is busy: waiting for a processor"


def wants_all_processors() -> bool:
    """Return True if other processes use all processors (False if unknown)."""
    if sys.platform == "win32":
        return False
    try:
        wanting = os.getloadavg()[0] - 1.0  # one is the answering process
    except OSError:
        return False
    return wanting >= (os.cpu_count() or 1)


def how_long(seconds_left: float | None, *, is_held_up: bool) -> str:
    """Return the time left, or that the machine is busy, or ""."""
    if is_held_up:
        return MACHINE_IS_BUSY
    return "" if seconds_left is None else f"about {lasting(seconds_left)} left"


class Pace:
    """Progress, time left, and whether a busy machine causes a delay."""

    def __init__(
        self, clock: Callable[[], float] = time.monotonic, is_busy: Callable[[], bool] = wants_all_processors
    ) -> None:
        self._clock = clock
        self._is_busy = is_busy
        self._began = self._got_on = clock()
        self._first: tuple[float, float] | None = None
        self._last: tuple[float, float] | None = None

    def note(self, share: float = 0.0) -> None:
        """Record that `share` (0 to 1, 0 if unknown) of the work is done."""
        self._got_on = self._clock()
        if share > 0.0:
            self._last = self._got_on, share
            self._first = self._first or self._last

    @property
    def is_held_up(self) -> bool:
        """True without progress for a while on a busy machine."""
        return self._clock() - self._got_on >= PATIENCE and self._is_busy()

    @property
    def seconds_left(self) -> float | None:
        """Estimated seconds left, or None before the first result.

        Later estimates exclude the time before the first result, which may include compilation.
        """
        if self._last is None or self._first is None:
            return None
        began, before = self._first if self._last[1] > self._first[1] else (self._began, 0.0)
        now, share = self._last
        return (now - began) * (1.0 - share) / (share - before)
