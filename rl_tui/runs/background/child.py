"""The process that answers one request and ends with its stdin.

It lowers its priority before it imports what the work needs.
"""

from __future__ import annotations

import os
import pickle
import pkgutil
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from typing import IO, Final

NICENESS: Final = 5
"""Priority at first, mild because another process may be waiting for the machine code compiled here."""
LAST_NICENESS: Final = 19
SESSION_NICENESS: Final = 10
"""Priority of the session where Linux divides processors among sessions: about a tenth of a processor."""
LENGTH: Final = 8
"""Number of bytes that hold the length of a message."""
LONGEST: Final = 4_000_000
"""Largest answer in bytes. Curves of four runs take a tenth; Q*(γ) of all pairs is the largest."""
LONGEST_REASON: Final = 200
"""Longest failure text in characters."""


def main(work: str) -> None:
    """Answer the request on stdin with the function `work` (`module:name`), then end the process.

    `work` receives the request and a function that sends an answer and the completed share (0 to 1). The last
    message is the reason for a failure, or "".
    """
    stdin, stdout = _own_pipes()
    if sys.platform != "win32":
        with suppress(OSError):
            os.nice(NICENESS)
    modules, request = pickle.load(stdin)  # written by our own program
    threading.Thread(target=_end_with, args=(stdin,), daemon=True).start()

    def send(message: object) -> None:
        sent = pickle.dumps(message)
        if len(sent) > LONGEST:
            raise ValueError(f"a result of {len(sent):,} bytes; at most {LONGEST:,} are allowed")
        stdout.write(len(sent).to_bytes(LENGTH, "big") + sent)
        stdout.flush()

    try:
        send(_failure_of(work, modules, request, lambda answer, share: send((answer, share))))
    finally:
        os._exit(0)  # an environment may have left threads that block a normal exit


def _failure_of(
    work: str, modules: frozenset[str], request: object, tell: Callable[[object, float], None]
) -> str:
    from rl_tui.common.errors import UserError
    from rl_tui.common.findings import one_line
    from rl_tui.worlds.gym.modules import ALLOWED

    ALLOWED.update(modules)
    try:
        pkgutil.resolve_name(work)(request, tell)
    except Exception as error:  # a world may raise anything
        name = "" if isinstance(error, UserError) else f"{type(error).__name__}: "
        return one_line(f"{name}{error}", LONGEST_REASON)
    return ""


def let_others_go_first() -> None:
    """Take the lowest priority that still makes progress, for good."""
    if sys.platform == "win32":
        return
    for thread in _threads():
        with suppress(OSError):
            os.setpriority(os.PRIO_PROCESS, thread, LAST_NICENESS)
    # Linux may divide processors among sessions first, and this process has its own session
    with suppress(OSError), open("/proc/self/autogroup", "w", encoding="ascii") as of_session:
        of_session.write(str(SESSION_NICENESS))


def bound_processor_time(seconds: int) -> None:
    """Let the system end this process after `seconds` of CPU time."""
    if sys.platform == "win32":
        return
    import resource

    with suppress(OSError, ValueError):
        resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))


def _own_pipes() -> tuple[IO[bytes], IO[bytes]]:
    """Take over stdin and stdout, so that an environment cannot use them."""
    stdin, stdout = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    nothing = os.open(os.devnull, os.O_RDWR)
    for each in (0, 1):
        os.dup2(nothing, each)
    return stdin, stdout


def _end_with(stdin: IO[bytes]) -> None:
    stdin.read()
    os._exit(0)


def _threads() -> list[int]:
    """Return all threads, for which Linux sets priorities one by one."""
    try:
        return list(map(int, os.listdir("/proc/self/task")))
    except OSError:
        return [0]  # this process
