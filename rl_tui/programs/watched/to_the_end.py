"""Watching a program to its end, without a screen."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import Final

from rl_tui.programs.watched.program_log import ProgramError, ProgramLog
from rl_tui.programs.watched.program_process import ProgramProcess, ProgramRequest

TIME_LIMIT: Final = "TimeLimit"
"""The type of the error of a program that took too long."""
_LOOK: Final = 0.1  # seconds
_AFTER_THE_END: Final = 3.0
"""Seconds that a program may go on once its steps are taken, or it has said that it is over."""


def watched_to_the_end(
    request: ProgramRequest,
    on_progress: Callable[[ProgramLog], None] = lambda _: None,
    seconds: float | None = None,
    log: ProgramLog | None = None,
) -> ProgramLog:
    """Return all that the program of ``request`` told until it ended, or ``seconds`` were over.

    ``on_progress`` is called about ten times a second, or oftener, and may raise to end it. ``log`` is what
    takes it in, if that is at hand. Raises OSError where no process can be started.
    """
    log, process = log or ProgramLog(), ProgramProcess(request)
    limit = math.inf if seconds is None else time.monotonic() + seconds
    farewell = math.inf
    try:
        while not (process.closed or log.is_garbled) and time.monotonic() < min(limit, farewell):
            for letter, payload in process.frames(_LOOK):
                log.take(letter, payload)
            on_progress(log)
            if farewell == math.inf and (log.ended or _has_taken(log, request.steps)):
                farewell = time.monotonic() + _AFTER_THE_END
    finally:
        process.end()
    if not (log.ended or _has_taken(log, request.steps)):
        file, line = log.stands_at or ("", None)
        log.error = ProgramError(TIME_LIMIT, f"the program was ended after {seconds:g} seconds", file, line)
    elif not log.ended and log.stands_at is not None:
        log.notes.append(f"after the last step the program stayed in line {log.stands_at[1]}, and was ended")
    return log


def _has_taken(log: ProgramLog, steps: int | None) -> bool:
    return steps is not None and log.recording.count >= steps
