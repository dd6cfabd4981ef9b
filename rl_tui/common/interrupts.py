"""Telling ctrl+C from an environment that raises KeyboardInterrupt itself."""

from __future__ import annotations

import signal
import threading
from types import FrameType


class _Interrupts:
    """Whether ctrl+C was pressed since the process looks out for it."""

    def __init__(self) -> None:
        self.came = False

    def note(self, _: int, __: FrameType | None) -> None:
        """Handle the signal as Python does, and remember it."""
        self.came = True
        raise KeyboardInterrupt


INTERRUPTS = _Interrupts()


def note_interrupts() -> None:
    """Look out for ctrl+C from now on, unless another handler does or it is ignored. For the main thread."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, INTERRUPTS.note)


def is_interrupt(error: BaseException) -> bool:
    """Return True if ``error`` is ctrl+C, which only the main thread gets, and no fault of a world.

    Where nothing looks out for it, it is taken for one, if there can be any.
    """
    if not isinstance(error, KeyboardInterrupt) or threading.current_thread() is not threading.main_thread():
        return False
    handler = signal.getsignal(signal.SIGINT)
    return INTERRUPTS.came if handler == INTERRUPTS.note else callable(handler)
