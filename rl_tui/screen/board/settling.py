"""When all that was asked for is done and on screen: what pictures and tests wait for."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from typing import Final

from rl_tui.common.errors import UserError
from rl_tui.live.snapshot import Snapshot
from rl_tui.screen.board.board import Board
from rl_tui.screen.board.wanted import PlayerLink
from rl_tui.screen.kit.snapshot_facts import lacks_exact

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
