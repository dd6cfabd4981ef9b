"""Watching a program to its end, without a screen."""

from __future__ import annotations

from collections.abc import Callable

from rl_tui.lab.programs.program_log import ProgramLog
from rl_tui.lab.programs.program_process import ProgramProcess, ProgramRequest


def watched_to_the_end(
    request: ProgramRequest, on_progress: Callable[[ProgramLog], None] = lambda _: None
) -> ProgramLog:
    """Return all that the program of ``request`` told until it ended, or its pipe was closed."""
    log, process = ProgramLog(), ProgramProcess(request)
    try:
        while not process.closed:
            for letter, payload in process.frames(None):
                log.take(letter, payload)
            on_progress(log)
    finally:
        process.end()
    return log
