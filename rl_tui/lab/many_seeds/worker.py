"""The process that works out a study for another one.

On stdin it reads one request; on stdout it tells, a line of JSON each, what is known. It ends with its stdin.
"""

from __future__ import annotations

import json
import os
import pickle
import threading
from contextlib import suppress
from typing import IO, TYPE_CHECKING, Final

if TYPE_CHECKING:
    from rl_tui.lab.many_seeds.figures import SeedStudy
    from rl_tui.lab.many_seeds.request import StudyRequest

NICENESS: Final = 5
"""How much lower its priority is while it gets machine code: another process may wait for the same."""
LAST_NICENESS: Final = 19


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
    from rl_tui.lab.many_seeds.estimates import as_json
    from rl_tui.lab.many_seeds.figures import SeedStudy, StudyState
    from rl_tui.lab.many_seeds.study import Study
    from rl_tui.worlds.gym.modules import ALLOWED

    def tell(study: SeedStudy) -> None:
        stdout.write(json.dumps(as_json(study)).encode() + b"\n")
        stdout.flush()

    ALLOWED.update(request.modules)
    try:
        study = Study(request)
    except UserError as fault:
        tell(SeedStudy(StudyState.FAILED, message=str(fault)))
        return
    if study.has_machine_code and not request.is_awaited:
        _let_others_go_first()
    study.get_machine_code()
    if not request.is_awaited:
        _let_others_go_first()
    for report in study.reports():
        tell(report)


def _let_others_go_first() -> None:
    """Take the lowest priority there is; nothing raises it again."""
    with suppress(AttributeError, OSError):
        os.setpriority(os.PRIO_PROCESS, 0, LAST_NICENESS)
    with suppress(AttributeError, OSError):
        os.sched_setscheduler(0, os.SCHED_IDLE, os.sched_param(0))
