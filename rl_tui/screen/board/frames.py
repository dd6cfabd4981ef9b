"""Frames of the playground, drawn only as fast as the terminal shows them."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import suppress
from time import monotonic
from typing import Final

from textual.screen import Screen

from rl_tui.common.errors import UserError
from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.board.board import Board
from rl_tui.screen.board.wanted import PlayerLink
from rl_tui.screen.kit.snapshot_facts import lacks_exact
from rl_tui.screen.terminal.linked_app import LinkedApp

# Pacing


_LOAD = 2.0  # idle time after a frame, in multiples of its cost
_MEMORY = 0.7  # weight of the past in the running mean of the cost of a frame
_HURRIED_FRAMES = 2  # the first may have been on its way before the key was pressed


async def _at_once() -> None:
    """Return at once, for terminals that do not report arrival."""


class Pacer:
    """A wait between frames, longer after slow ones and none after a key press.

    ``fps`` is the most frames per second. ``arrived`` returns when the terminal shows everything sent.
    """

    def __init__(
        self,
        fps: float,
        arrived: Callable[[], Awaitable[None]] = _at_once,
        clock: Callable[[], float] = monotonic,
    ) -> None:
        self._interval = 1.0 / fps
        self._arrived = arrived
        self._clock = clock
        self._began = clock() - self._interval
        self._cost = 0.0
        self._hurry = asyncio.Event()
        self._hurried = 0

    def hurry(self) -> None:
        """Draw the next two frames without waiting."""
        self._hurried = _HURRIED_FRAMES
        self._hurry.set()

    def begin(self) -> None:
        """Note the start of a frame."""
        self._hurried = max(0, self._hurried - 1)
        if not self._hurried:
            self._hurry.clear()
        self._began = self._clock()

    def end(self) -> None:
        """Note the end of a frame."""
        self._cost = _MEMORY * self._cost + (1.0 - _MEMORY) * (self._clock() - self._began)

    @property
    def pause(self) -> float:
        """Seconds until the next frame may start."""
        return max(0.0, self._began + max(self._interval, _LOAD * self._cost) - self._clock())

    async def wait(self) -> None:
        """Wait until the next frame is due, or :meth:`hurry` is called."""
        waits = [asyncio.ensure_future(each) for each in (self._due(), self._hurry.wait())]
        try:
            await asyncio.wait(waits, return_when=asyncio.FIRST_COMPLETED)
        finally:
            for each in waits:
                each.cancel()

    async def _due(self) -> None:
        await asyncio.sleep(self.pause)
        await self._arrived()


# Drawing


_ASKS_AGAIN: Final = 0.25  # seconds


class Frames:
    """The frames of ``screen``, each after the arrival of the last one."""

    def __init__(self, screen: Screen[None], fps: float) -> None:
        self._screen = screen
        self.pacer = Pacer(fps, self._arrived)

    @property
    def is_here(self) -> bool:
        """True if the screen is still in use."""
        screen = self._screen
        return screen.is_attached and screen.app.is_running and screen in screen.app.screen_stack

    async def follow(
        self,
        snapshots: AsyncIterator[Snapshot],
        draw: Callable[[Snapshot], None],
        note_frame: Callable[[], None],
    ) -> None:
        """Draw each of ``snapshots``, and call ``note_frame`` after it."""
        async for snapshot in snapshots:
            if not self.is_here:
                return
            self.pacer.begin()
            draw(snapshot)
            await self.painted()
            self.pacer.end()
            note_frame()
            await self.pacer.wait()

    async def _arrived(self) -> None:
        if isinstance(self._screen.app, LinkedApp):
            await self._screen.app.arrived()

    async def painted(self) -> None:
        """Wait until the drawing is on screen, or the screen is left."""
        painted = asyncio.Event()
        # a dialog on top gets the request, and forgets it when it closes
        while not painted.is_set() and self._screen.call_after_refresh(painted.set):
            with suppress(TimeoutError):
                await asyncio.wait_for(painted.wait(), _ASKS_AGAIN)


# Waiting until everything is on screen, for pictures and tests


_MOST_PICTURES: Final = 100  # before giving up


class Settling:
    """The wait for a picture that shows everything."""

    def __init__(
        self,
        link: PlayerLink,
        board: Board,
        look_at: Callable[[], None],
        named: Callable[[UserError], UserError],
        painted: Callable[[], Awaitable[None]],
    ) -> None:
        self._link = link
        self._board = board
        self._look_at = look_at
        self._named = named
        self._painted = painted
        self._framed = asyncio.Event()
        self._is_over = False

    def note_frame(self) -> None:
        """Note that the newest snapshot is on screen."""
        self._framed.set()

    def end(self) -> None:
        """Note that nothing more will be drawn."""
        self._is_over = True
        self._framed.set()

    async def settled(self) -> None:
        """Wait until everything asked for is done and on screen, or the run is over.

        Gives up after many pictures.
        """
        for _ in range(_MOST_PICTURES):
            if self._is_over:
                return
            self._framed.clear()
            done = await self._carried_out()
            if self._link.snapshot is not done:
                await self._framed.wait()  # this snapshot or a newer one will be drawn
            else:
                await self._painted()
            if self._link.snapshot is done and not lacks_exact(done) and self._board.is_complete:
                return
            while not self._is_over and self._link.snapshot and lacks_exact(self._link.snapshot):
                self._framed.clear()
                await self._framed.wait()
            if not self._board.is_complete:
                self._look_at()

    async def _carried_out(self) -> Snapshot:
        try:
            return await self._link.player.carried_out()
        except UserError as fault:
            raise self._named(fault) from fault
