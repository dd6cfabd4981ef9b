"""Sends the drawing frame by frame: all changes since the last one arrived."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from contextlib import suppress
from time import monotonic
from typing import Final

from rich.color import ColorSystem

from rl_tui.screen.terminal.encoder import Encoder, move_to
from rl_tui.screen.terminal.link import ANSWER_LINE, Link
from rl_tui.screen.terminal.pens import Pens
from rl_tui.screen.terminal.screen_buffer import Cutter, ScreenBuffer

_ASK: Final = "\x1b[6n"
_ERASE_ALL: Final = "\x1b[2J"
SYNC_BEGIN, SYNC_END = "\x1b[?2026h", "\x1b[?2026l"  # the terminal shows nothing until the end
_LOOK_AGAIN: Final = 0.02  # seconds
_LONGEST_FAREWELL: Final = 2.0  # seconds to wait for the last answer


class Output:
    """A drawing on a terminal, which needs a running event loop."""

    def __init__(
        self,
        write: Callable[[str], None],
        system: ColorSystem,
        waiting: Callable[[], int] = int,
        clock: Callable[[], float] = monotonic,
    ) -> None:
        pens, cutter = Pens(system), Cutter()
        self.link = Link(clock)
        self.buffer = ScreenBuffer(pens, cutter)
        """The contents to send."""
        self.cursor = (0, 0)
        """The place of the hidden cursor, where input methods show typed text."""
        self.synchronises = False
        self._write = write
        self._waiting = waiting
        self._encoder = Encoder(pens, cutter)
        self._timer: asyncio.TimerHandle | None = None
        self._arrived = asyncio.Event()
        self._rests = False
        self._beside = ""  # text where nothing is drawn
        self._erases = False

    @property
    def keeps_up(self) -> bool:
        """True if the link is fast and no drawing waits."""
        return not (self.link.is_slow or self.buffer.is_touched)

    def write_beside(self, x: int, y: int, words: str) -> None:
        """Write outside the drawing, instead of earlier ``words``."""
        self._erases = bool(words or self._beside)
        self._beside = f"{move_to(x, y)}{words}" if words else ""

    def resize(self, width: int, height: int) -> None:
        """Start again on an unknown terminal, but wait for :meth:`wake`."""
        self._rests = True
        if (width, height) == (self.buffer.width, self.buffer.height):
            self.buffer.forget()
            self.link.restart()
        else:
            self.buffer.resize(width, height)

    def stop(self) -> None:
        """Send nothing until :meth:`wake`."""
        self._rests = True

    def wake(self) -> None:
        """Send everything since the resize, and go on."""
        self._rests = False
        self.send()

    def draw_again(self) -> None:
        """Send everything again."""
        self.buffer.forget()
        self.send()

    def send(self) -> None:
        """Send the changes, now or after the last frame."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
        while self.buffer.is_touched and not self._rests:
            if (wait := self._wait) > 0.0:
                self._timer = asyncio.get_running_loop().call_later(wait, self.send)
                return
            if text := self._encoder.frame(self.buffer.changed(), self.link.room):
                if self._erases:
                    text, self._erases = f"{_ERASE_ALL}{text}", False
                # with every frame, because erasing the rest of a line erases this too
                self._write(self._framed(text + self._beside))

    def answer(self, column: int, line: int) -> None:
        """Take the terminal's cursor position (from 0)."""
        if self.link.answer(column, line):
            self.send()
            self._arrived.set()
            self._arrived = asyncio.Event()

    async def arrived(self) -> None:
        """Wait until the terminal shows everything, or has not answered in time."""
        self.send()
        while (wait := self._wait) > 0.0:
            await self._answered(wait)
            self.send()

    async def rest(self) -> None:
        """Send nothing until :meth:`wake`, and wait for the last answer."""
        self._rests = True
        loop = asyncio.get_running_loop()
        deadline = loop.time() + _LONGEST_FAREWELL
        while not self.link.is_idle and loop.time() < deadline:
            await self._answered(deadline - loop.time())

    @property
    def _wait(self) -> float:
        """The seconds until sending or checking again, if no answer comes."""
        wait = self.link.wait
        return wait if wait > 0.0 or not self._waiting() else _LOOK_AGAIN

    async def _answered(self, seconds: float) -> None:
        with suppress(TimeoutError):
            await asyncio.wait_for(self._arrived.wait(), seconds)

    def _framed(self, text: str) -> str:
        frame = f"{SYNC_BEGIN}{text}{SYNC_END}" if self.synchronises else text
        if self.buffer.height > ANSWER_LINE:
            column = self.link.send(len(frame.encode()), self.buffer.width)
            if column is not None:
                frame += move_to(column, ANSWER_LINE) + _ASK
        if self.cursor != (0, 0):
            frame += move_to(*self.cursor)
        return frame
