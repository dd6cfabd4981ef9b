"""The other side: what runs in a process that answers one request.

On stdin it reads the request; on stdout it tells, a line of JSON each, what is known. It ends with its stdin.
"""

from __future__ import annotations

import json
import os
import pickle
import threading
from collections.abc import Callable
from contextlib import suppress
from typing import IO, Any, Final

NICENESS: Final = 5
"""How much lower its priority is at first: another process may wait for the machine code it gets."""
LAST_NICENESS: Final = 19
SESSION_NICENESS: Final = 10
"""That of its session, where Linux shares processors out among sessions: it gets some tenth of one."""


def answer(work: Callable[[Any, Callable[[dict[str, Any]], None]], None]) -> None:
    """Let ``work`` answer what stdin asks for, and end the process when that is done or stdin ends.

    ``work`` is given the request and what tells an answer, and should let nothing escape.
    """
    stdin, stdout = _own_pipes()
    with suppress(AttributeError, OSError):
        os.nice(NICENESS)
    # Our own program wrote it
    request = pickle.load(stdin)
    threading.Thread(target=_end_with, args=(stdin,), daemon=True).start()

    def tell(document: dict[str, Any]) -> None:
        stdout.write(json.dumps(document).encode() + b"\n")
        stdout.flush()

    try:
        work(request, tell)
    finally:
        os._exit(0)  # an environment may have left threads behind, and would want a farewell


def let_others_go_first() -> None:
    """Take the lowest priority that still gets on where others never rest; nothing raises it again."""
    for thread in _threads():
        with suppress(AttributeError, OSError):
            os.setpriority(os.PRIO_PROCESS, thread, LAST_NICENESS)
    # Linux may share the processor out among sessions first, and this process has one of its own
    with suppress(OSError), open("/proc/self/autogroup", "w", encoding="ascii") as of_session:
        of_session.write(str(SESSION_NICENESS))


def bound_processor_time(seconds: int) -> None:
    """End this process once it has used so many seconds of a processor, where the system can see to it."""
    with suppress(ImportError, OSError, ValueError):
        import resource

        resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))


def _own_pipes() -> tuple[IO[bytes], IO[bytes]]:
    """Keep stdin and stdout for this module: an environment reads nothing there, and prints into the void."""
    stdin, stdout = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    nothing = os.open(os.devnull, os.O_RDWR)
    for each in (0, 1):
        os.dup2(nothing, each)
    return stdin, stdout


def _end_with(stdin: IO[bytes]) -> None:
    stdin.read()
    os._exit(0)


def _threads() -> list[int]:
    """Return all threads of this process, also those of a library: on Linux each has its own priority."""
    try:
        return list(map(int, os.listdir("/proc/self/task")))
    except OSError:
        return [0]  # this process
