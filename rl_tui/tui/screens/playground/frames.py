"""Drawing what a player publishes: one frame at a time, the newest, as often as the terminal keeps up."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import suppress
from typing import Final

from textual.screen import Screen

from rl_tui.lab.live.snapshot import Snapshot
from rl_tui.terminal.linked_app import LinkedApp
from rl_tui.tui.screens.playground.frame_pacing import Pacer

_ASKS_AGAIN: Final = 0.25  # seconds


class Frames:
    """The frames of ``screen``, at most ``fps`` a second; none is drawn before the last has arrived."""

    def __init__(self, screen: Screen[None], fps: float) -> None:
        self._screen = screen
        self._pacer = Pacer(fps, self._arrived)

    def hurry(self) -> None:
        """Draw the next frames at once: a person has asked for something."""
        self._pacer.hurry()

    @property
    def is_here(self) -> bool:
        """Whether it is one of the screens still: of one that is left, or of an end, the panels go first."""
        screen = self._screen
        return screen.is_attached and screen.app.is_running and screen in screen.app.screen_stack

    async def follow(
        self,
        snapshots: AsyncIterator[Snapshot],
        draw: Callable[[Snapshot], None],
        note_frame: Callable[[], None],
    ) -> None:
        """Draw each of ``snapshots`` until the screen is left; ``note_frame`` hears that one is painted.

        Raises what ended the snapshots.
        """
        async for snapshot in snapshots:
            if not self.is_here:
                return
            self._pacer.begin()
            draw(snapshot)
            await self.painted()
            self._pacer.end()
            note_frame()
            await self._pacer.wait()

    async def _arrived(self) -> None:
        if isinstance(self._screen.app, LinkedApp):
            await self._screen.app.arrived()

    async def painted(self) -> None:
        """Wait until what was drawn is on screen, or the screen is left."""
        painted = asyncio.Event()
        # the screen on top is asked to tell, and a dialog that closes forgets what it was asked
        while not painted.is_set() and self._screen.call_after_refresh(painted.set):
            with suppress(TimeoutError):
                await asyncio.wait_for(painted.wait(), _ASKS_AGAIN)
