"""The driver for terminals, even slow, stopped or lost ones."""

from __future__ import annotations

import asyncio
import os
import signal
import sys
import termios
from codecs import getincrementaldecoder
from collections.abc import Callable, Iterator
from contextlib import suppress
from selectors import EVENT_READ, SelectSelector
from threading import Event, Thread
from typing import Any, Final

from textual.app import App
from textual.drivers.linux_driver import LinuxDriver
from textual.events import InputEvent, Key
from textual.message import Message

from rl_tui.screen.terminal.ending import HUNG_UP, end_at_last, end_with, hear
from rl_tui.screen.terminal.input_parser import InputParser
from rl_tui.screen.terminal.linked_app import LinkedApp
from rl_tui.screen.terminal.output import SYNC_END
from rl_tui.screen.terminal.writer import TerminalWriter

assert sys.platform != "win32"  # for mypy, which skips the rest there

LONGEST_FAREWELL: Final = 3.0  # seconds
MOST_WAITING: Final = 1_000  # keys and other input in the queue of the app
_LAST_WORDS: Final = 0.5  # seconds to put the terminal in order at the end
# Like Textual's farewell: no bracketed paste, line wrap, no reports of size, mouse and focus, normal
# keyboard, screen and cursor. First the end of an unfinished sequence or frame
_IN_ORDER: Final = (
    f"\x18{SYNC_END}\x1b[?2004l\x1b[?7h\x1b[?2048l\x1b[?1000l\x1b[?1003l\x1b[?1015l\x1b[?1006l\x1b[?1004l"
    "\x1b[<u\x1b[?1049l\x1b[?25h"
)
_TICK: Final = 0.1  # seconds until an escape counts as a key
_AT_ONCE: Final = 4096  # bytes read


class TerminalDriver(LinuxDriver):
    """Textual's driver for Unix, for slow, stopped and lost terminals too.

    ``write`` never waits. If the terminal is gone, the app gets ``Lost``, and the process ends seconds later
    at the latest.
    """

    class Lost(Message):
        """The terminal is gone."""

    def __init__(
        self, app: App[Any], *, debug: bool = False, mouse: bool = True, size: tuple[int, int] | None = None
    ) -> None:
        may_stop = signal.getsignal(signal.SIGTSTP) is not signal.SIG_IGN
        super().__init__(app, debug=debug, mouse=mouse, size=size)
        if not may_stop:  # a shell without job control could not resume it
            signal.signal(signal.SIGTSTP, signal.SIG_IGN)
        # copies of Textual's private attributes
        self._app, self._debug, self._loop = app, debug, asyncio.get_running_loop()
        self._may_stop = may_stop
        # Textual writes to stderr, which may be redirected to a file
        output = sys.__stdout__ or sys.stdout
        self._encoding = output.encoding
        self._output = TerminalWriter(output.fileno(), self._lose)
        self._is_lost = False
        self._is_away = False
        self._has_terminal = False
        self._sent = self._arrived = 0  # messages for the app: counted by the reader, by the event loop
        self._continued = 0
        self._shall_stop = False
        with suppress(ValueError):
            hear(signal.SIGTSTP, self._on_stop)
            hear(signal.SIGCONT, self._on_continue)

    # Writing

    def write(self, data: str) -> None:
        """Queue ``data`` for the terminal."""
        self._output.write(data.encode(self._encoding, "replace"))

    @property
    def waiting(self) -> int:
        """The bytes not taken yet."""
        return self._output.waiting

    # Start and end

    def start_application_mode(self) -> None:
        """Take over the terminal."""
        self._has_terminal = True
        super().start_application_mode()  # type: ignore[no-untyped-call]
        if (textuals := getattr(self, "_writer_thread", None)) is not None:  # it has nothing to write
            textuals.stop()
            self._writer_thread = None

    def stop_application_mode(self) -> None:
        """Restore the terminal, and drop waiting pictures."""
        self._output.forget()
        if isinstance(self._app, LinkedApp) and self._app.synchronises:
            self.write(SYNC_END)  # the dropped bytes may hold the end of a synchronised frame
        super().stop_application_mode()
        self._output.drain(LONGEST_FAREWELL)
        self._has_terminal = False

    def give_back(self) -> None:
        """Restore the terminal right before the process ends, in any state of the app."""
        if not self._has_terminal:
            return
        self._output.forget()
        with suppress(OSError, termios.error):
            if self.attrs_before is not None:
                termios.tcsetattr(self.fileno, termios.TCSANOW, self.attrs_before)
        last = Thread(target=_write_at_last, args=(self._output.fileno, _IN_ORDER.encode()), daemon=True)
        last.start()
        last.join(_LAST_WORDS)

    def close(self) -> None:
        """End the writer."""
        super().close()
        if not self._is_away:
            self._output.close(LONGEST_FAREWELL)

    def _get_terminal_size(self) -> tuple[int, int]:
        # the environment may hold the size of another terminal
        with suppress(OSError):
            size = os.get_terminal_size(self.fileno)
            if size.columns and size.lines:
                return size.columns, size.lines
        return super()._get_terminal_size()

    # Reading

    def process_message(self, message: Message) -> None:
        """Hand on input, unless more waits than a person can type."""
        waiting = self._sent - self._arrived + self._app.message_queue_size
        stops = (
            isinstance(self._app, LinkedApp) and isinstance(message, Key) and message.key in self._app.stops
        )
        most = 2 * MOST_WAITING if stops else MOST_WAITING  # stop keys are not lost in a flood
        if waiting < most or not isinstance(message, InputEvent):
            super().process_message(message)

    def send_message(self, message: Message) -> None:
        """Queue ``message``, from the reader thread."""
        self._sent += 1
        self._soon(self._arrive, message)  # Textual would make a task of some kilobytes for each

    def _arrive(self, message: Message) -> None:
        self._arrived += 1
        self._app.post_message(message)

    # Losing the terminal

    def _run_input_thread(self) -> None:
        try:
            for message in messages_from(self.fileno, self.exit_event, debug=self._debug):
                self.process_message(message)
        except (EOFError, OSError):
            self._lose()
        except Exception as fault:  # no key would be read any more: better to end and say why
            end_with(self._app, fault)

    def _lose(self) -> None:
        if not self._is_lost:
            self._is_lost = True
            end_at_last(HUNG_UP)
            self._soon(self._app.post_message, self.Lost())

    def _soon(self, do: Callable[..., object], *args: object) -> None:
        with suppress(RuntimeError):  # the loop has ended, and the program is about to
            self._loop.call_soon_threadsafe(do, *args)

    # Stop and resume

    @property
    def can_suspend(self) -> bool:
        """True if a shell can resume after ctrl+z."""
        with suppress(OSError):
            parent = os.getppid()  # 0 if it is in another container
            return self._may_stop and parent > 0 and os.getsid(parent) == os.getsid(0)
        return False

    async def suspend(self) -> bool:
        """Give the terminal back and stop until the shell resumes the program.

        Returns False if no shell controls it, so that it goes on at once.
        """
        before = self._continued
        await self._leave(_stop_group)
        return self._continued != before

    def _sigtstp_application(self, *_: object) -> None:
        # sent by another process, which can also resume the program
        pass  # :func:`hear` handles the signal, in order with the others

    def _on_stop(self, _: int) -> None:
        self._shall_stop = True
        with suppress(RuntimeError):
            asyncio.run_coroutine_threadsafe(self._leave(self._stop_if_still_asked), self._loop)

    def _on_continue(self, _: int) -> None:
        self._shall_stop = False

    def _stop_if_still_asked(self) -> None:
        if self._shall_stop:
            os.kill(os.getpid(), signal.SIGSTOP)

    def _sigcont_application(self, *_: object) -> None:
        self._continued += 1
        if not self._is_away:  # stopped without warning: another program may have used the terminal
            self._soon(self._pause, lambda: None)  # already stopped

    async def _leave(self, stop: Callable[[], None]) -> None:
        if isinstance(self._app, LinkedApp) and not self._is_away:
            await self._app.rest()
        self._pause(stop)

    def _pause(self, stop: Callable[[], None]) -> None:
        if self._is_away or not self._app.is_running:
            return
        self._is_away = True
        self.suspend_application_mode()
        stop()
        while self._is_in_background():
            before = self._continued
            os.killpg(0, signal.SIGTTIN)
            if self._continued == before:  # no shell can bring it to the foreground
                break
        self._is_away = False
        self.resume_application_mode()
        self._app.call_later(self._draw_anew)

    def _is_in_background(self) -> bool:
        try:
            return os.tcgetpgrp(self.fileno) != os.getpgrp()
        except OSError:  # the terminal is gone; the next read reports it
            return False

    def _draw_anew(self) -> None:
        self._app.app_resume_signal.publish(self._app)
        self._app.refresh(layout=True)


def _write_at_last(fileno: int, data: bytes) -> None:
    with suppress(OSError):
        os.write(fileno, data)


def _stop_group() -> None:
    """Stop the process group, but not if no shell could resume it."""
    ours = signal.signal(signal.SIGTSTP, signal.SIG_DFL)
    try:
        os.killpg(0, signal.SIGTSTP)
    finally:
        signal.signal(signal.SIGTSTP, ours)


def messages_from(fileno: int, ended: Event, *, debug: bool = False) -> Iterator[Message]:
    """Yield the terminal's messages until ``ended`` is set.

    Raises:
        EOFError, OSError: The terminal is gone.
    """
    parser = InputParser(debug=debug)
    decode = getincrementaldecoder("utf-8")("replace").decode
    with SelectSelector() as selector:
        selector.register(fileno, EVENT_READ)
        while not ended.is_set():
            if selector.select(_TICK):
                yield from parser.feed(decode(_read(fileno)))
            yield from parser.tick()
        if selector.select(_TICK):  # drop a late answer or mouse movement
            _read(fileno)


def _read(fileno: int) -> bytes:
    try:
        data = os.read(fileno, _AT_ONCE)
    except BlockingIOError:  # another program shares the terminal, has made it non-blocking, and was quicker
        return b""
    if not data:
        raise EOFError
    return data
