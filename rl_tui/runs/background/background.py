"""The asking side of background computations."""

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

ENDED_BY_ITSELF: Final = "its process ended without a result"
_LOOKS: Final = 1.0  # seconds between two checks of progress


class Background(Generic[Asked, Known]):
    """Answers one request at a time in a separate process.

    `work` is a function like `module:name`, with the signature in `child.main`. Its answers must consist of
    values from modules that are imported here too. `on_news` is called from any thread.
    """

    def __init__(self, work: str, on_news: Callable[[], None]) -> None:
        self.process: AnsweringProcess[Asked, Known] | None = None
        """The current or last process, or None before the first request."""
        self._work = work
        self._on_news = on_news
        self._lock = threading.Lock()  # guards `process` and `_is_closed`
        self._is_closed = False

    def begin(self, request: Asked, known: Known) -> AnsweringProcess[Asked, Known] | None:
        """Start to answer `request` instead of any other, or return None once closed.

        Call it from one thread only. `known` is the first answer. Raises OSError.
        """
        self.end()
        with self._lock:
            if not self._is_closed:
                self.process = AnsweringProcess(self._work, request, known, self._on_news)
            return self.process

    def end(self) -> None:
        """Stop and forget the current process."""
        with self._lock:
            process, self.process = self.process, None
        if process is not None:
            process.end()

    def close(self) -> None:
        """Stop the current process and refuse new ones. Safe from any thread."""
        with self._lock:
            self._is_closed = True
            if self.process is not None:
                self.process.end()


class AnsweringProcess(Generic[Asked, Known]):
    """A process that answers `request`, and ends no later than this program.

    `on_news` is called from another thread for each answer, each change of `is_held_up` and the end. Raises
    OSError.
    """

    def __init__(self, work: str, request: Asked, known: Known, on_news: Callable[[], None]) -> None:
        self.request = request
        self.known = known
        """The latest answer."""
        self.failed = ""
        """Why the work stopped early, empty unless it failed."""
        self.pace = Pace()
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
        except RuntimeError as error:  # the system limits the number of threads
            self._process.kill()
            self._process.wait()
            self._over.set()
            raise OSError(str(error)) from error

    @property
    def is_held_up(self) -> bool:
        """True while a busy machine delays the process."""
        return self.pace.is_held_up and not self._over.is_set()

    def why_failed(self, ended: str) -> str:
        """Return why the work failed (`ended` if unexplained), or ""."""
        return ended if self.failed == ENDED_BY_ITSELF else self.failed

    @property
    def how_long(self) -> str:
        """Time left, or that the machine is busy."""
        return how_long(self.pace.seconds_left, is_held_up=self.is_held_up)

    def end(self) -> None:
        """Stop the process without waiting for its end."""
        self._process.kill()

    def wait(self) -> None:
        """Wait until the process has ended."""
        self._reader.join()

    def _talk(self) -> None:
        stdin, stdout = self._process.stdin, self._process.stdout
        assert stdin is not None
        assert stdout is not None
        failed = ENDED_BY_ITSELF
        with open(stdout.fileno(), "rb", closefd=False) as answers, stdout, stdin:
            try:
                with suppress(OSError):  # the process has already ended
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
        """Report delays, during which the process sends no answer."""
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
    while 0 < (length := int.from_bytes(stdout.read(LENGTH), "big")) <= LONGEST:
        sent = stdout.read(length)
        if len(sent) < length:
            return
        yield pickle.loads(sent)  # written by our own program
