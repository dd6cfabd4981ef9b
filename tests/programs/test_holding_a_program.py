"""A program that is released and held again at once stops."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from program_watching import LEARNS, written

from rl_tui.programs.watched.messages import NO_LIMIT
from rl_tui.programs.watched.program_process import ProgramRequest
from rl_tui.programs.watched.watched_program import WatchedProgram

pytestmark = pytest.mark.process
PATIENCE = 60.0


@pytest.fixture
def program(tmp_path: Path) -> Iterator[WatchedProgram]:
    path = written(tmp_path, f"import os; print(os.getpid(), flush=True)\n{LEARNS}", episodes=1_000_000)
    program = WatchedProgram(ProgramRequest(path))
    program.wait_for_environment()
    yield program
    program.end()


def settle(program: WatchedProgram) -> int:
    deadline = time.monotonic() + PATIENCE
    while not program.is_settled:
        assert time.monotonic() < deadline, program.log.waiting_at
        program.listen(0.05)
    return program.log.recording.count


def test_one_that_slept_through_it_still_comes_to_rest(program: WatchedProgram) -> None:
    here, process = settle(program), int(program.log.output[0].text)
    os.kill(process, signal.SIGSTOP)  # as if the machine had given it no CPU time
    program.let()
    program.hold()
    os.kill(process, signal.SIGCONT)
    assert settle(program) == here


def test_each_time_it_takes_exactly_the_steps_that_it_may(program: WatchedProgram) -> None:
    for steps in range(1, 40):
        program.let(NO_LIMIT)
        if steps % 2:
            program.listen(0.001 * steps)
        program.hold()
        here = settle(program)
        program.let(here + steps)
        assert settle(program) == here + steps


def test_what_it_met_before_it_heard_otherwise_does_not_hold_it(program: WatchedProgram) -> None:
    for _ in range(20):
        here = settle(program)
        program.stop_at({"states": [0, 4]})
        program.let(here + 50)
        program.stop_at({})
        assert settle(program) in range(here + 1, here + 51)
        if program.stopped_by is not None:
            program.let(here + 50)
            settle(program)
        assert program.log.recording.count == here + 50
