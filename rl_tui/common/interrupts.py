"""Ctrl+C, as distinct from an environment that raises KeyboardInterrupt."""

from __future__ import annotations

import os
import signal
import threading
from types import FrameType
from typing import Final, NoReturn

INTERRUPTED: Final = 130
"""Exit status of a process ended by ctrl+C."""


class _Interrupts:
    def __init__(self) -> None:
        self.came = False

    def note(self, _: int, __: FrameType | None) -> None:
        self.came = True
        raise KeyboardInterrupt


INTERRUPTS = _Interrupts()


def leave_when_interrupted() -> None:
    """Let ctrl+C end the process immediately and silently, with status 130.

    This is for start and end, when Python would print a traceback. Call it in the main thread. An ignored
    ctrl+C stays ignored.
    """
    if signal.getsignal(signal.SIGINT) in (signal.default_int_handler, INTERRUPTS.note):
        signal.signal(signal.SIGINT, _leave)


def note_interrupts() -> None:
    """Record ctrl+C from now on, unless it is ignored or handled elsewhere.

    Call it in the main thread.
    """
    if signal.getsignal(signal.SIGINT) in (signal.default_int_handler, _leave):
        signal.signal(signal.SIGINT, INTERRUPTS.note)


def _leave(_: int, __: FrameType | None) -> NoReturn:
    os._exit(INTERRUPTED)


def is_interrupt(error: BaseException) -> bool:
    """Return True if `error` is ctrl+C and not an error of an environment.

    Only the main thread receives ctrl+C. Without a recorded signal, every KeyboardInterrupt counts if ctrl+C
    is possible.
    """
    if not isinstance(error, KeyboardInterrupt) or threading.current_thread() is not threading.main_thread():
        return False
    handler = signal.getsignal(signal.SIGINT)
    return INTERRUPTS.came if handler == INTERRUPTS.note else callable(handler)
