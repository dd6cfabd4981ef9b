"""While an environment is asked for something: since when, and where what it prints goes."""

from __future__ import annotations

import sys
import threading
import time
from types import TracebackType
from typing import Final, TextIO

# An environment that nobody holds any more is closed, and so asked, in the middle of anything
_LOCK: Final = threading.RLock()
# By the thread that waits for the answer
_SINCE: Final = dict[int, float]()


class _Aside:
    """Lets all that environments print go to stderr: stdout is for results.

    They may be asked in several threads at once, and whoever drives a terminal may exchange the streams
    meanwhile: then they stay as that one left them.
    """

    def __init__(self) -> None:
        self._asked = 0
        self._before: TextIO | None = None
        self._instead: TextIO | None = None

    def begin(self) -> None:
        with _LOCK:
            self._asked += 1
            if self._asked == 1:
                self._before, self._instead = sys.stdout, sys.stderr
                sys.stdout = self._instead

    def end(self) -> None:
        with _LOCK:
            if self._asked == 1 and sys.stdout is self._instead:
                sys.stdout = self._before
            self._asked -= 1


_ASIDE: Final = _Aside()


class Asking:
    """A context in which an environment is asked for something. May not be entered again inside itself."""

    def __enter__(self) -> None:
        _SINCE[threading.get_ident()] = time.perf_counter()
        _ASIDE.begin()

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        _ASIDE.end()
        _SINCE.pop(threading.get_ident(), None)


ASKING: Final = Asking()


def unanswered(thread: int | None) -> float:
    """Return for how many seconds an environment has kept ``thread``, an identifier, waiting; 0 for not."""
    since = None if thread is None else _SINCE.get(thread)
    return 0.0 if since is None else time.perf_counter() - since
