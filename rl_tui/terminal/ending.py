"""Ending from outside: the terminal is closed, the machine shuts down."""

from __future__ import annotations

import asyncio
import os
import signal
from collections.abc import Callable, Iterable
from contextlib import suppress
from threading import Timer
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from textual.app import App

LONGEST: Final = 6.0
HUNG_UP: Final = 129  # the exit status of a program whose terminal was closed
_SIGNALS: Final = ("SIGTERM", "SIGHUP", "SIGINT", "SIGQUIT")  # Windows does not know all of them


def end_at_last(status: int) -> None:
    """Let the process be gone with ``status`` some seconds later, whatever it waits for.

    A terminal that is gone may keep the farewell waiting for ever.
    """
    last_resort = Timer(LONGEST, os._exit, (status,))
    last_resort.daemon = True
    last_resort.start()


def end_with(app: App[Any], fault: Exception) -> None:
    """Have ``app`` end and say why; from any thread."""

    def fail() -> None:
        raise fault

    app.call_later(fail)


def end_on_signal(end: Callable[[int], None]) -> None:
    """Call ``end`` with the exit status when a signal ends the program; the process ends some seconds later.

    What is ignored, as nohup does, stays ignored. Nothing happens where signals cannot be awaited.
    """

    def on_signal(number: int) -> None:
        status = 128 + number  # as shells say it
        end_at_last(status)
        end(status)

    on_signals(_SIGNALS, on_signal)


def on_signals(names: Iterable[str], do: Callable[[int], object]) -> None:
    """Have the running event loop call ``do`` with the number of each signal that comes, if not ignored."""
    loop = asyncio.get_running_loop()
    for name in names:
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) is not signal.SIG_IGN:
            with suppress(NotImplementedError, RuntimeError, ValueError):
                loop.add_signal_handler(number, do, number)
