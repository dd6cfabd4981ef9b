"""Frames of the playground, drawn only as often as the terminal keeps up, and when all is on screen."""

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


_LOAD = 2.0  # a frame is followed by at least as much idle time as it took
_MEMORY = 0.7  # weight of the past in the running mean of what a frame costs
_HURRIED_FRAMES = 2  # the first may have been on its way before the key was pressed


async def _at_once() -> None:
    """Return at once: where it is not known when a frame has arrived."""


class Pacer:
    """Waits between frames.

    ``fps`` is the most frames a second. ``arrived`` returns once the terminal shows what it was sent, and
    ``clock`` tells seconds. A frame that took long to draw stretches the wait; one that a person asked for by
    pressing a key is not kept waiting: it is drawn even while another is on its way, so that what it changes
    is the next to be sent.
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
        """Let the next two frames come at once."""
        self._hurried = _HURRIED_FRAMES
        self._hurry.set()

    def begin(self) -> None:
        """Note that a frame is being drawn."""
        self._hurried = max(0, self._hurried - 1)
        if not self._hurried:
            self._hurry.clear()
        self._began = self._clock()

    def end(self) -> None:
        """Note that the frame is drawn."""
        self._cost = _MEMORY * self._cost + (1.0 - _MEMORY) * (self._clock() - self._began)

    @property
    def pause(self) -> float:
        """Seconds to wait before the next frame, wherever the last one is."""
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
    """The frames of ``screen``, at most ``fps`` a second; none is drawn before the last has arrived."""

    def __init__(self, screen: Screen[None], fps: float) -> None:
        self._screen = screen
        self.pacer = Pacer(fps, self._arrived)

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
        """Wait until what was drawn is on screen, or the screen is left."""
        painted = asyncio.Event()
        # the screen on top is asked to tell, and a dialog that closes forgets what it was asked
        while not painted.is_set() and self._screen.call_after_refresh(painted.set):
            with suppress(TimeoutError):
                await asyncio.wait_for(painted.wait(), _ASKS_AGAIN)


# When all that was asked for is on screen: what pictures and tests wait for


_MOST_PICTURES: Final = 100  # until a picture that shows what was asked for


class Settling:
    """Waits for a picture that shows everything.

    ``look_at`` has those parts of a large world copied that are in view, ``named`` says of which session a
    fault is, ``painted`` waits until all that was drawn is on screen.
    """

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
        """Tell that the newest snapshot is on screen."""
        self._framed.set()

    def end(self) -> None:
        """Tell that nothing more will be drawn."""
        self._is_over = True
        self._framed.set()

    async def settled(self) -> None:
        """Wait until all that was asked for is done and on screen, the exact answer included.

        Where it was left, or a fault has ended the run, there is nothing to wait for. What does not come to
        rest in many pictures never will, and is not waited for either.
        """
        for _ in range(_MOST_PICTURES):
            if self._is_over:
                return
            self._framed.clear()
            done = await self._carried_out()
            if self._link.snapshot is not done:
                await self._framed.wait()  # it comes to be drawn too, or a newer one
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
