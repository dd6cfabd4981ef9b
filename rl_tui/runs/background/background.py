"""Questions that are answered in the background, as seen by the program that asks."""

from __future__ import annotations

import os
import pickle
import threading
from collections.abc import Callable, Iterator
from contextlib import suppress
from typing import IO, Any, Final, Generic, TypeVar

from rl_tui.agents.compiling.base_folder import base_folder
from rl_tui.common.child_process import python_process
from rl_tui.common.findings import one_line
from rl_tui.runs.background.child import LENGTH, LONGEST, LONGEST_REASON
from rl_tui.runs.background.pace import Pace, how_long
from rl_tui.worlds.gym import modules

Asked = TypeVar("Asked")
Known = TypeVar("Known")

ENDED_BY_ITSELF: Final = "its process ended by itself"
_LOOKS: Final = 1.0  # seconds from one look to the next at whether it gets on


class Background(Generic[Asked, Known]):
    """Answers one request at a time, in a process of its own.

    The function ``work`` (``module:name``) runs in it: :func:`~rl_tui.runs.background.child.main` says how it
    is called. What it answers with should be values of modules that are imported here too. ``on_news`` is
    called, from any thread, when there is more to tell.
    """

    def __init__(self, work: str, on_news: Callable[[], None]) -> None:
        self.process: AnsweringProcess[Asked, Known] | None = None
        """What is under way, or was last; None where nothing was asked."""
        self._work = work
        self._on_news = on_news
        self._lock = threading.Lock()  # guards the process and whether there may be one
        self._is_closed = False

    def begin(self, request: Asked, known: Known) -> AnsweringProcess[Asked, Known] | None:
        """Begin to answer ``request``, in place of any other; None once this is closed.

        ``known`` is the answer until the first one comes. To be called from one thread. Raises OSError where
        no process can be started.
        """
        self.end()
        with self._lock:
            if not self._is_closed:
                self.process = AnsweringProcess(self._work, request, known, self._on_news)
            return self.process

    def end(self) -> None:
        """End what is under way, and forget it."""
        with self._lock:
            process, self.process = self.process, None
        if process is not None:
            process.end()

    def close(self) -> None:
        """End what is under way, from any thread, and begin nothing any more."""
        with self._lock:
            self._is_closed = True
            if self.process is not None:
                self.process.end()


class AnsweringProcess(Generic[Asked, Known]):
    """A process that answers ``request`` by ``work``, and ends with this one, however that ends.

    ``on_news`` is called, in a thread of its own, when an answer has come, when no more will come, and when
    the process is held up or no longer is. Raises OSError where no process can be started.
    """

    def __init__(self, work: str, request: Asked, known: Known, on_news: Callable[[], None]) -> None:
        self.request = request
        """What is asked."""
        self.known = known
        """The last answer."""
        self.failed = ""
        """Why no more answers come, though the work is not done; empty unless it was broken off."""
        self.pace = Pace()
        """How it gets on."""
        self._on_news = on_news
        self._over = threading.Event()
        self._process = python_process(
            "rl_tui.runs.background.child",
            {"work": work},
            os.environ | {"RL_TUI_CACHE_DIR": str(base_folder().absolute())},
        )
        self._reader = threading.Thread(target=self._talk, name=work, daemon=True)
        try:
            threading.Thread(target=self._watch, name=f"pace of {work}", daemon=True).start()
            self._reader.start()
        except RuntimeError as error:  # there may be only so many threads
            self._process.kill()
            self._process.wait()
            self._over.set()
            raise OSError(str(error)) from error

    @property
    def is_held_up(self) -> bool:
        """Whether a busy machine keeps it waiting."""
        return self.pace.is_held_up and not self._over.is_set()

    def why_failed(self, ended: str) -> str:
        """Return why no more answers come, ``ended`` where the process ended by itself; empty if they may."""
        return ended if self.failed == ENDED_BY_ITSELF else self.failed

    @property
    def how_long(self) -> str:
        """How long the rest takes, or that the machine is busy; empty where neither is known."""
        return how_long(self.pace.seconds_left, is_held_up=self.is_held_up)

    def end(self) -> None:
        """End it, whatever it is doing; this does not wait."""
        self._process.kill()

    def wait(self) -> None:
        """Wait until it has ended, be it by :meth:`end`."""
        self._reader.join()

    def _talk(self) -> None:
        """Ask, take in what it answers, and see it to its end."""
        stdin, stdout = self._process.stdin, self._process.stdout
        assert stdin is not None
        assert stdout is not None
        failed = ENDED_BY_ITSELF
        with open(stdout.fileno(), "rb", closefd=False) as answers, stdout, stdin:
            try:
                with suppress(OSError):  # it has ended already
                    _send(stdin, pickle.dumps((frozenset(modules.ALLOWED), self.request)))
                for message in _messages(answers):
                    if isinstance(message, str):
                        failed = message
                        break
                    self.known, share = message
                    self.pace.note(share)
                    self._on_news()
            except Exception as error:  # an environment may have written to the pipe
                failed = one_line(f"{type(error).__name__}: {error}", LONGEST_REASON)
            finally:
                self._process.kill()
                self._process.wait()
                self.failed = failed
                self._over.set()
        self._on_news()

    def _watch(self) -> None:
        """Notice when it does not get on: no answer says so."""
        was_held_up = False
        while not self._over.wait(_LOOKS):
            if self.is_held_up is not was_held_up:
                was_held_up = not was_held_up
                self._on_news()


def _send(stdin: IO[bytes], message: bytes) -> None:
    left = memoryview(message)
    while left:
        left = left[stdin.write(left) :]


def _messages(stdout: IO[bytes]) -> Iterator[Any]:
    """Yield what is sent, until no more is, or more at once than there may be."""
    while 0 < (length := int.from_bytes(stdout.read(LENGTH), "big")) <= LONGEST:
        sent = stdout.read(length)
        if len(sent) < length:
            return
        yield pickle.loads(sent)  # our own program wrote it
