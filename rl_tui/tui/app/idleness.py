"""A terminal that was left alone: the run is paused when no key is pressed for a while."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Final

PATIENCE: Final = 600.0
"""Seconds without a key or a movement of the mouse until the run of a kiosk is paused."""
LOOKS: Final = 10.0
"""Seconds between two looks at the clock."""


class Idleness:
    """Tells for how long there was no key and no movement of the mouse. ``clock`` gives seconds."""

    def __init__(self, patience: float = PATIENCE, clock: Callable[[], float] = time.monotonic) -> None:
        self._patience = patience
        self._clock = clock
        self._last = clock()
        self._has_begun = False

    def stir(self) -> None:
        """Note that a key or the mouse was used."""
        self._last = self._clock()
        self._has_begun = False

    def begins(self) -> bool:
        """Return True once each time that nothing was used for ``patience`` seconds."""
        begins = not self._has_begun and self._clock() - self._last >= self._patience
        self._has_begun = self._has_begun or begins
        return begins
