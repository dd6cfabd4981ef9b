"""How much a browser may send: a person is never slowed down, a program that floods an app is."""

from __future__ import annotations

import asyncio
from typing import Final

# In a second 125 movements of the mouse, 30 repetitions of a key and 60 answers to frames come to less
PER_SECOND: Final = 6_000.0  # characters
AT_ONCE: Final = 20_000.0
OF_A_MESSAGE: Final = 16  # characters that every message counts for beside its own


class Allowance:
    """Fills up by ``per_second`` to ``at_once``; what is spent beyond it is waited for."""

    def __init__(self, per_second: float = PER_SECOND, at_once: float = AT_ONCE) -> None:
        self._per_second = per_second
        self._at_once = at_once
        self._left = at_once
        self._filled = asyncio.get_running_loop().time()

    async def spend(self, characters: int) -> None:
        """Return when a message of so many characters may be handed on."""
        now = asyncio.get_running_loop().time()
        self._left = min(self._left + (now - self._filled) * self._per_second, self._at_once)
        self._filled = now
        self._left -= characters + OF_A_MESSAGE
        if self._left < 0:
            await asyncio.sleep(-self._left / self._per_second)
