"""Frames, drawn only as fast as the terminal shows them."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from contextlib import suppress
from time import monotonic
from typing import Final

from textual.screen import Screen

from rl_tui.common.errors import UserError
from rl_tui.live.commands import LookAt
from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.board.board import Board
from rl_tui.screen.board.wanted import PlayerLink
from rl_tui.screen.kit.snapshot_facts import lacks_exact
from rl_tui.screen.terminal.linked_app import LinkedApp, is_open

# Pacing


_LOAD = 2.0  # idle time after a frame, in multiples of its cost
_MEMORY = 0.7  # weight of the past in the running mean of the cost of a frame
_HURRIED_FRAMES = 2  # the first may have been on its way before the key was pressed


async def _at_once() -> None:
    """Return at once, for terminals that do not report arrival."""


class Pacer:
    """A wait between frames, longer after slow ones and none after a key press.

    ``fps``: most frames per second. ``arrived`` returns when the terminal shows everything sent.
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
        """Note a frame's start."""
        self._hurried = max(0, self._hurried - 1)
        if not self._hurried:
            self._hurry.clear()
        self._began = self._clock()

    def end(self) -> None:
        """Note a frame's end."""
        self._cost = _MEMORY * self._cost + (1.0 - _MEMORY) * (self._clock() - self._began)

    @property
    def pause(self) -> float:
        """The seconds until the next frame."""
        return max(0.0, self._began + max(self._interval, _LOAD * self._cost) - self._clock())

    async def wait(self) -> None:
        """Wait for the next frame, or :meth:`hurry`."""
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
_MOST_PICTURES: Final = 100  # before giving up


class Frames:
    """Frames, each after the arrival of the last. ``named`` names the file of an error."""

    def __init__(
        self,
        screen: Screen[None],
        fps: float,
        link: PlayerLink,
        board: Board,
        named: Callable[[UserError], UserError],
    ) -> None:
        self._screen = screen
        self.pacer = Pacer(fps, self._arrived)
        self._link = link
        self._board = board
        self._named = named
        self._framed = asyncio.Event()
        self._is_over = False

    async def follow(self, draw: Callable[[Snapshot], None]) -> None:
        """Draw each snapshot of the player."""
        async for snapshot in self._link.player.snapshots():
            if not is_open(self._screen):
                return
            self.pacer.begin()
            draw(snapshot)
            await self._painted()
            self.pacer.end()
            self._framed.set()
            await self.pacer.wait()

    async def _arrived(self) -> None:
        if isinstance(self._screen.app, LinkedApp):
            await self._screen.app.arrived()

    async def _painted(self) -> None:
        painted = asyncio.Event()
        # a dialog on top gets the request, and forgets it when it closes
        while not painted.is_set() and self._screen.call_after_refresh(painted.set):
            with suppress(TimeoutError):
                await asyncio.wait_for(painted.wait(), _ASKS_AGAIN)

    def end(self) -> None:
        """Note that nothing more will be drawn."""
        self._is_over = True
        self._framed.set()

    async def settled(self) -> None:
        """Wait until everything is done and on screen, the run is over, or for many pictures."""
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
                self._link.send(LookAt(self._board.viewport))

    async def _carried_out(self) -> Snapshot:
        try:
            return await self._link.player.carried_out()
        except UserError as fault:
            raise self._named(fault) from fault
