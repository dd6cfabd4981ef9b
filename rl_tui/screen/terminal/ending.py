"""Signals, and ending from outside: the terminal is closed, the machine shuts down.

Python calls the handlers of signals from the main thread only, those that came together by their numbers, and
asyncio once its loop comes round to it: a loop that is kept busy would keep the program alive. Here a thread
of its own hears of every signal at once, in the order in which they came.
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
_SIGNALS: Final = ("SIGTERM", "SIGHUP", "SIGINT", "SIGQUIT")  # Windows does not know all of them


def _nothing() -> None:
    pass


def end_at_last(status: int, give_back: Callable[[], object] = _nothing) -> None:
    """Let the process be gone with ``status`` some seconds later, whatever it waits for.

    A terminal that is gone may keep the farewell waiting for ever. ``give_back`` is called right before, from
    another thread.
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
    """Have ``app`` end and say why; from any thread."""

    def fail() -> None:
        raise fault

    app.call_later(fail)


def end_on_signal(end: Callable[[int], None], give_back: Callable[[], object] = _nothing) -> None:
    """Have the running event loop call ``end`` with the exit status when a signal ends the program.

    The process is gone some seconds later, whatever the loop does; ``give_back``, called from another thread,
    then leaves the terminal in order. What is ignored, as nohup does, stays ignored. Nothing happens where
    signals cannot be awaited.
    """
    loop = asyncio.get_running_loop()

    def on_signal(number: int) -> None:
        status = 128 + number  # as shells say it
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
    """Have the running event loop call ``do`` with the number of each signal that comes, if not ignored."""
    loop = asyncio.get_running_loop()
    for name in names:
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) is not signal.SIG_IGN:
            with suppress(NotImplementedError, RuntimeError, ValueError):
                loop.add_signal_handler(number, do, number)


def hear(number: int, do: Callable[[int], object]) -> None:
    """Have ``do`` called, in a thread, with the ``number`` of that signal whenever it comes.

    Signals are heard in the order in which they came. The signal needs a handler of Python as well, be it one
    that does nothing. Raises ValueError outside of the main thread, NotImplementedError on Windows.
    """
    if sys.platform == "win32":
        raise NotImplementedError
    _EARS.listen()
    _EARS.calls[number] = do


class _Ears:
    """The thread that hears of signals, and the pipe into which the interpreter puts their numbers."""

    def __init__(self) -> None:
        self.calls: dict[int, Callable[[int], object]] = {}
        self._pipe: tuple[int, int] | None = None

    def listen(self) -> None:
        """Begin to; or again, where something else has had the interpreter put the numbers elsewhere."""
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
