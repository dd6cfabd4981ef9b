"""The process that works out a study for another one.

On stdin it reads one request; on stdout it tells, a line of JSON each, what is known. It ends with its stdin.
"""

from __future__ import annotations

import json
import os
import pickle
import threading
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from typing import IO, TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from rl_tui.lab.many_seeds.figures import SeedStudy
    from rl_tui.lab.many_seeds.request import StudyRequest

NICENESS: Final = 5
"""How much lower its priority is while it gets machine code: another process may wait for the same."""
LAST_NICENESS: Final = 19
_LONGEST_REASON: Final = 200


def main() -> None:
    """Work out what stdin asks for, and end when that is done or stdin ends, be it in the middle."""
    stdin, stdout = _own_pipes()
    with suppress(AttributeError, OSError):
        os.nice(NICENESS)
    # Our own program wrote it
    request: StudyRequest = pickle.load(stdin)
    threading.Thread(target=_end_with, args=(stdin,), daemon=True).start()
    try:
        _work(request, stdout)
    finally:
        os._exit(0)  # an environment may have left threads behind, and would want a farewell


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


def _work(request: StudyRequest, stdout: IO[bytes]) -> None:
    from rl_tui.common.errors import UserError
    from rl_tui.common.findings import one_line
    from rl_tui.lab.many_seeds.estimates import as_json
    from rl_tui.lab.many_seeds.figures import StudyState
    from rl_tui.worlds.gym.modules import ALLOWED

    ALLOWED.update(request.modules)
    told = request.nothing_yet
    try:
        for told in _reports(request):
            _tell(stdout, as_json(told))
    except Exception as error:  # whatever a world may do to this process
        name = "" if isinstance(error, UserError) else f"{type(error).__name__}: "
        why = one_line(f"{name}{error}", _LONGEST_REASON)
        _tell(stdout, as_json(replace(told, state=StudyState.FAILED, message=why)))


def _reports(request: StudyRequest) -> Iterator[SeedStudy]:
    """Yield what is known, at the lowest priority as soon as there is machine code."""
    from rl_tui.lab.many_seeds.study import Study

    study = Study(request)
    if study.has_machine_code and not request.is_awaited:
        _let_others_go_first()
    study.get_machine_code()
    if not request.is_awaited:
        _let_others_go_first()
    yield from study.reports()


def _tell(stdout: IO[bytes], told: dict[str, Any]) -> None:
    stdout.write(json.dumps(told).encode() + b"\n")
    stdout.flush()


def _let_others_go_first() -> None:
    """Take the lowest priority there is; nothing raises it again."""
    for thread in _threads():
        with suppress(AttributeError, OSError):
            os.setpriority(os.PRIO_PROCESS, thread, LAST_NICENESS)
        with suppress(AttributeError, OSError):
            os.sched_setscheduler(thread, os.SCHED_IDLE, os.sched_param(0))
    # Linux may share the processor out among sessions first, and this process has one of its own
    with suppress(OSError), open("/proc/self/autogroup", "w", encoding="ascii") as of_session:
        of_session.write(str(LAST_NICENESS))


def _threads() -> list[int]:
    """Return all threads of this process, also those of a library: on Linux each has its own priority."""
    try:
        return list(map(int, os.listdir("/proc/self/task")))
    except OSError:
        return [0]  # this process
