"""Scripts that tests run step by step."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from watched_scripts import PATIENCE, script_in

from rl_tui.programs.watched.messages import NO_LIMIT
from rl_tui.programs.watched.program_log import ProgramLog
from rl_tui.programs.watched.program_process import ProgramProcess, ProgramRequest


class Held:
    """A program that takes only permitted steps. ``log`` holds its messages so far."""

    def __init__(self, process: ProgramProcess) -> None:
        self.process, self.log = process, ProgramLog()

    def until(self, is_so: Callable[[ProgramLog], bool]) -> ProgramLog:
        end = time.monotonic() + PATIENCE
        while not is_so(self.log):
            assert time.monotonic() < end, self.log
            assert not self.process.closed, self.log
            for letter, payload in self.process.frames(1.0):
                self.log.take(letter, payload)
        return self.log

    def go_to(self, steps: int) -> ProgramLog:
        self.process.allow(steps)
        return self.until(lambda log: log.waiting_at == steps and log.heard == self.process.asked)

    def stop_at(self, **conditions: Any) -> ProgramLog:
        self.log.stopped_by = None
        self.process.ask({"stop": conditions})
        self.process.allow(NO_LIMIT)
        asked = self.process.asked - 1  # ignores conditions met before it received them
        log = self.until(lambda log: (log.stopped_by is not None and log.heard >= asked) or log.ended)
        self.process.allow(log.recording.count)
        return log


@contextmanager
def held(folder: Path, text: str, **more: Any) -> Iterator[Held]:
    process = ProgramProcess(ProgramRequest(script_in(folder, text), **more), allowed=0)
    try:
        yield Held(process)
    finally:
        process.end()
