"""Signals, and orders to end from outside: a closed terminal or a shutdown.

Python and asyncio call signal handlers late or never if the main thread is busy. Here a separate thread
receives every signal at once and in order.
"""

from __future__ import annotations

import asyncio
import os
import signal
import sys
from collections.abc import Callable, Iterable
from contextlib import suppress
from threading import Thread, Timer
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from textual.app import App

LONGEST: Final = 6.0
HUNG_UP: Final = 129  # the exit status of a program whose terminal was closed
_SIGNALS: Final = ("SIGTERM", "SIGHUP", "SIGINT", "SIGQUIT")  # some do not exist on Windows


def _nothing() -> None:
    pass


def end_at_last(status: int, give_back: Callable[[], object] = _nothing) -> None:
    """End the process after some seconds, even if it hangs.

    Another thread calls ``give_back`` right before.
    """

    def leave() -> None:
        try:
            give_back()
        finally:
            os._exit(status)

    last_resort = Timer(LONGEST, leave)
    last_resort.daemon = True
    last_resort.start()


def end_with(app: App[Any], fault: Exception) -> None:
    """Make ``app`` fail, from any thread."""

    def fail() -> None:
        raise fault

    app.call_later(fail)


def end_on_signal(end: Callable[[int], None], give_back: Callable[[], object] = _nothing) -> None:
    """Make the event loop call ``end`` with the exit status when a signal ends the program.

    The process ends some seconds later in any case, after ``give_back`` from another thread. Ignored signals
    (nohup) stay ignored.
    """
    loop = asyncio.get_running_loop()

    def on_signal(number: int) -> None:
        status = 128 + number  # as in shells
        end_at_last(status, give_back)
        with suppress(RuntimeError):  # the loop has ended, and the program is about to
            loop.call_soon_threadsafe(end, status)

    for name in _SIGNALS:
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) is not signal.SIG_IGN:
            with suppress(NotImplementedError, ValueError):
                hear(number, on_signal)
                signal.signal(number, lambda *_: None)


def on_signals(names: Iterable[str], do: Callable[[int], object]) -> None:
    """Make the event loop call ``do`` with these signals, if not ignored."""
    loop = asyncio.get_running_loop()
    for name in names:
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) is not signal.SIG_IGN:
            with suppress(NotImplementedError, RuntimeError, ValueError):
                loop.add_signal_handler(number, do, number)


def hear(number: int, do: Callable[[int], object]) -> None:
    """Call ``do`` in a thread with the signal's ``number`` whenever it comes, in order.

    The signal also needs a Python handler.

    Raises:
        ValueError: Called outside the main thread.
        NotImplementedError: Windows does not support it.
    """
    if sys.platform == "win32":
        raise NotImplementedError
    _EARS.listen()
    _EARS.calls[number] = do


class _Ears:
    """The thread that receives signals, and the pipe for their numbers."""

    def __init__(self) -> None:
        self.calls: dict[int, Callable[[int], object]] = {}
        self._pipe: tuple[int, int] | None = None

    def listen(self) -> None:
        if sys.platform == "win32":
            return
        if self._pipe is None:
            reading, writing = os.pipe()
            os.set_blocking(writing, False)
            self._pipe = reading, writing
            Thread(target=self._live, args=(reading,), name="signals", daemon=True).start()
        signal.set_wakeup_fd(self._pipe[1], warn_on_full_buffer=False)

    def _live(self, reading: int) -> None:
        while numbers := os.read(reading, 1):
            do = self.calls.get(numbers[0])
            if do is not None:
                do(numbers[0])


_EARS: Final = _Ears()
