"""What ctrl+C does, and telling it from an environment that raises KeyboardInterrupt itself."""

from __future__ import annotations

import os
import signal
import threading
from types import FrameType
from typing import Final, NoReturn

INTERRUPTED: Final = 130
"""The exit status of a process that ctrl+C has ended."""


class _Interrupts:
    """Whether ctrl+C was pressed since the process looks out for it."""

    def __init__(self) -> None:
        self.came = False

    def note(self, _: int, __: FrameType | None) -> None:
        """Handle the signal as Python does, and remember it."""
        self.came = True
        raise KeyboardInterrupt


INTERRUPTS = _Interrupts()


def leave_when_interrupted() -> None:
    """Let ctrl+C end the process at once, with 130 and without a word, unless it is ignored.

    It is for the time before there is anything to give back, and after: Python would print a traceback,
    in whichever import it came. For the main thread.
    """
    if signal.getsignal(signal.SIGINT) in (signal.default_int_handler, INTERRUPTS.note):
        signal.signal(signal.SIGINT, _leave)


def note_interrupts() -> None:
    """Look out for ctrl+C from now on, unless another handler does or it is ignored. For the main thread."""
    if signal.getsignal(signal.SIGINT) in (signal.default_int_handler, _leave):
        signal.signal(signal.SIGINT, INTERRUPTS.note)


def _leave(_: int, __: FrameType | None) -> NoReturn:
    os._exit(INTERRUPTED)


def is_interrupt(error: BaseException) -> bool:
    """Return True if ``error`` is ctrl+C, which only the main thread gets, and no fault of a world.

    Where nothing looks out for it, it is taken for one, if there can be any.
    """
    if not isinstance(error, KeyboardInterrupt) or threading.current_thread() is not threading.main_thread():
        return False
    handler = signal.getsignal(signal.SIGINT)
    return INTERRUPTS.came if handler == INTERRUPTS.note else callable(handler)
