"""A terminal that somebody forgot: the run is paused when nobody has pressed a key for a while."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Final

PATIENCE: Final = 600.0
"""Seconds without a key or a movement of the mouse until the run of a kiosk is paused."""
LOOKS: Final = 10.0
"""Seconds between two looks at the clock."""


class Idleness:
    """Tells when somebody was last there. ``clock`` gives seconds."""

    def __init__(self, patience: float = PATIENCE, clock: Callable[[], float] = time.monotonic) -> None:
        self._patience = patience
        self._clock = clock
        self._last = clock()
        self._told = False

    def stir(self) -> None:
        """Note that somebody is there."""
        self._last = self._clock()
        self._told = False

    def begins(self) -> bool:
        """Tell, once each time, that nobody has been there for as long as patience lasts."""
        begins = not self._told and self._clock() - self._last >= self._patience
        self._told = self._told or begins
        return begins
