"""Calls into environments: their duration, and their output to stderr."""

from __future__ import annotations

import sys
import threading
import time
from typing import Final, TextIO

# Reentrant, because garbage collection may close an environment during another call
_LOCK: Final = threading.RLock()
# Start of the current call, by thread
_SINCE: Final = dict[int, float]()


class EnvironmentCall:
    """A context for one call into an environment. It cannot be nested.

    Output goes to stderr, because stdout is for results. Several threads may call environments at once. If a
    terminal driver replaces the streams meanwhile, its change stays.
    """

    def __init__(self) -> None:
        self._calls = 0
        self._before: TextIO | None = None
        self._instead: TextIO | None = None

    def __enter__(self) -> None:
        _SINCE[threading.get_ident()] = time.perf_counter()
        with _LOCK:
            self._calls += 1
            if self._calls == 1:
                self._before, self._instead = sys.stdout, sys.stderr
                sys.stdout = self._instead

    def __exit__(self, *_: object) -> None:
        with _LOCK:
            if self._calls == 1 and sys.stdout is self._instead:
                sys.stdout = self._before
            self._calls -= 1
        _SINCE.pop(threading.get_ident(), None)


ENVIRONMENT_CALL: Final = EnvironmentCall()


def seconds_in_call(thread: int | None) -> float:
    """Return the seconds that a thread has been in a call, or 0."""
    since = None if thread is None else _SINCE.get(thread)
    return 0.0 if since is None else time.perf_counter() - since
