"""How a question gets on that is answered in the background."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from typing import Final

from rl_tui.common.words import lasting

PATIENCE: Final = 5.0
"""Seconds without progress after which it is said that the machine is busy, if it is."""
MACHINE_IS_BUSY: Final = "the machine is busy: waiting for a processor"


def wants_all_processors() -> bool:
    """Return whether other processes keep all processors busy; False where the system does not report it."""
    try:
        wanting = os.getloadavg()[0] - 1.0  # one is the process that answers
    except (AttributeError, OSError):
        return False
    return wanting >= (os.cpu_count() or 1)


def how_long(seconds_left: float | None, *, is_held_up: bool) -> str:
    """Return how long the rest takes, or that the machine is busy; empty where neither is known."""
    if is_held_up:
        return MACHINE_IS_BUSY
    return "" if seconds_left is None else f"about {lasting(seconds_left)} left"


class Pace:
    """When it last got on, how long the rest takes, and whether a busy machine keeps it waiting.

    ``clock`` gives seconds, ``is_busy`` whether other processes keep all processors busy.
    """

    def __init__(
        self, clock: Callable[[], float] = time.monotonic, is_busy: Callable[[], bool] = wants_all_processors
    ) -> None:
        self._clock = clock
        self._is_busy = is_busy
        self._began = self._got_on = clock()
        self._first: tuple[float, float] | None = None
        self._last: tuple[float, float] | None = None

    def note(self, share: float = 0.0) -> None:
        """Note that it has got on; ``share`` of the whole is done, 0 where that is not known."""
        self._got_on = self._clock()
        if share > 0.0:
            self._last = self._got_on, share
            self._first = self._first or self._last

    @property
    def is_held_up(self) -> bool:
        """Whether it has not got on for a while because the machine is busy."""
        return self._clock() - self._got_on >= PATIENCE and self._is_busy()

    @property
    def seconds_left(self) -> float | None:
        """Seconds from the last result to the end at the pace until then; None before the first result.

        What came before the first result may have been compiling, so later ones leave it out.
        """
        if self._last is None or self._first is None:
            return None
        began, before = self._first if self._last[1] > self._first[1] else (self._began, 0.0)
        now, share = self._last
        return (now - began) * (1.0 - share) / (share - before)
