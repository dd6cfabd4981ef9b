"""Where a watched program waits, and hears what the watching side asks."""

from __future__ import annotations

import json
import mmap
import os
import select
from collections.abc import Callable
from typing import Any, Final

from rl_tui.lab.programs.child.channel import Channel
from rl_tui.lab.programs.messages import MessageKind

_AT_ONCE: Final = 65_536  # bytes


class Gate:
    """Lets the program go as far as the memory behind ``shared`` says, and hears lines of ``asked``.

    ``on_asked`` is called with the value of each key that is heard and stands in it.
    """

    def __init__(self, channel: Channel, asked: int, shared: int) -> None:
        self._channel, self._asked = channel, asked
        self.allowed = memoryview(mmap.mmap(shared, mmap.PAGESIZE)).cast("q")
        """One number: how many steps it may take in all."""
        self.on_asked: dict[str, Callable[[Any], None]] = {}
        self._unread = b""
        self._heard = 0
        self._is_held = False
        self.is_waiting = False
        """Whether the program waits for leave to go on."""

    def wait(self, count: int, met: str | None) -> None:
        """Wait until more than ``count`` steps are allowed, and for a new "stop" where it ``met`` something.

        The process ends where nobody asks any more.
        """
        self._is_held = met is not None
        self.is_waiting = True
        while self._is_held or count >= self.allowed[0]:
            stopped = met if self._is_held else None
            self._channel.message(MessageKind.WAITING, step=count, stopped=stopped, heard=self._heard)
            self._hear()
        self.is_waiting = False
        self.listen()  # what was asked before it was allowed counts from the next step on

    def listen(self) -> None:
        """Hear what was asked, if anything was."""
        if select.select([self._asked], [], [], 0)[0]:
            self._hear()

    def _hear(self) -> None:
        heard = os.read(self._asked, _AT_ONCE)
        if not heard:
            self._channel.leave(0)
        *lines, self._unread = (self._unread + heard).split(b"\n")
        for line in lines:
            said = json.loads(line)
            self._heard = said["number"]
            self._is_held = self._is_held and "stop" not in said
            for key, value in said.items():
                if key in self.on_asked:
                    self.on_asked[key](value)
