"""The other side: what runs in a process that answers one request, and ends with its stdin.

It imports little, so that it has its priority before it loads what the work needs.
"""

from __future__ import annotations

import os
import pickle
import pkgutil
import threading
from collections.abc import Callable
from contextlib import suppress
from typing import IO, Final

NICENESS: Final = 5
"""How much lower its priority is at first: another process may wait for the machine code it gets."""
LAST_NICENESS: Final = 19
SESSION_NICENESS: Final = 10
"""That of its session, where Linux shares processors out among sessions: it gets some tenth of one."""
LENGTH: Final = 8
"""Bytes before each message that say how long it is."""
LONGEST: Final = 4_000_000
"""Bytes of one answer. The curves of four lanes are a tenth of it, Q*(γ) of all pairs is the longest."""
LONGEST_REASON: Final = 200
"""Characters of a text that says why the work failed."""


def main(work: str) -> None:
    """Let the function ``work`` (``module:name``) answer the request on stdin, then end the process.

    It is called with the request and a function that sends an answer and the share of the work that is done.
    The last message is a text: why the work failed, empty where it did not.
    """
    stdin, stdout = _own_pipes()
    with suppress(AttributeError, OSError):
        os.nice(NICENESS)
    modules, request = pickle.load(stdin)  # our own program wrote it
    threading.Thread(target=_end_with, args=(stdin,), daemon=True).start()

    def send(message: object) -> None:
        sent = pickle.dumps(message)
        if len(sent) > LONGEST:
            raise ValueError(f"an answer of {len(sent):,} bytes, of which {LONGEST:,} are the most")
        stdout.write(len(sent).to_bytes(LENGTH, "big") + sent)
        stdout.flush()

    try:
        send(_failure_of(work, modules, request, lambda answer, share: send((answer, share))))
    finally:
        os._exit(0)  # an environment may have left threads behind, and would want a farewell


def _failure_of(
    work: str, modules: frozenset[str], request: object, tell: Callable[[object, float], None]
) -> str:
    """Do the work, in which an environment may import ``modules``; return why it failed, empty if not."""
    from rl_tui.common.errors import UserError
    from rl_tui.common.findings import one_line
    from rl_tui.worlds.gym.modules import ALLOWED

    ALLOWED.update(modules)
    try:
        pkgutil.resolve_name(work)(request, tell)
    except Exception as error:  # whatever a world may do to this process
        name = "" if isinstance(error, UserError) else f"{type(error).__name__}: "
        return one_line(f"{name}{error}", LONGEST_REASON)
    return ""


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
