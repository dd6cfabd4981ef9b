"""A program waits in step and reset."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from held_programs import held
from program_watching import LEARNS, written
from watched_scripts import LOOP, script_in, watched

from rl_tui.programs.watched.messages import NO_LIMIT
from rl_tui.programs.watched.program_log import ProgramLog
from rl_tui.programs.watched.program_process import ProgramRequest
from rl_tui.programs.watched.watched_program import WatchedProgram

pytestmark = pytest.mark.process

SCRIPT = LOOP.format(episodes=100)


@pytest.fixture
def whole(tmp_path: Path) -> ProgramLog:
    return watched(script_in(tmp_path, SCRIPT, "whole.py"))


def _assert_is_so_far(log: ProgramLog, whole: ProgramLog) -> None:
    now, then = log.recording, whole.recording
    assert now.steps.state.tolist() == then.steps.state[: now.count].tolist()
    np.testing.assert_array_equal(now.table_at(now.count), then.table_at(now.count))


def test_it_takes_as_many_steps_as_it_may(tmp_path: Path, whole: ProgramLog) -> None:
    with held(tmp_path, SCRIPT) as program:
        for steps in (0, 1, 2, 50, 51):
            log = program.go_to(steps)
            assert log.recording.count == steps
            if steps:
                _assert_is_so_far(log, whole)


@pytest.mark.parametrize("limit", [1, 37])
def test_it_ends_after_so_many_steps(tmp_path: Path, whole: ProgramLog, limit: int) -> None:
    log = watched(script_in(tmp_path, SCRIPT), steps=limit)

    assert log.ended
    assert log.error is None
    assert log.recording.count == limit
    _assert_is_so_far(log, whole)


def test_it_stops_at_what_it_was_asked_for(tmp_path: Path, whole: ProgramLog) -> None:
    steps, episodes = whole.recording.steps, whole.recording.steps.episode
    first = {
        "states": (1 + int(np.flatnonzero(steps.next_state == 9)[0]), {"states": [9]}),
        "cells": (1 + int(np.flatnonzero(steps.state * 4 + steps.action == 17)[0]), {"cells": [17]}),
        "reward": (1 + int(np.flatnonzero(steps.reward)[0]), {"reward": True}),
        "episode_ends": (int(np.flatnonzero(episodes == 3)[0]), {"episode_ends": 3}),
        "episode": (int(np.flatnonzero(episodes == 5)[0]), {"episode": 5}),
        "value": (_first_below(whole, cell=1, value=-0.6), {"value": [1, -0.6]}),
        "policy": (_first_other_policy(whole), {"policy": True}),
    }
    for name, (step, conditions) in first.items():
        with held(tmp_path, SCRIPT) as program:
            program.go_to(0)
            log = program.stop_at(**conditions)

            assert (log.stopped_by, log.waiting_at, log.recording.count) == (name, step, step)
            _assert_is_so_far(log, whole)


def test_after_a_stop_it_goes_on_when_it_is_asked_anew(tmp_path: Path, whole: ProgramLog) -> None:
    ends = np.flatnonzero(whole.recording.steps.terminated | whole.recording.steps.truncated) + 1
    with held(tmp_path, SCRIPT) as program:
        program.go_to(0)
        for end in ends[:4]:
            assert program.stop_at(episode_ends=1).recording.count == end


def _first_below(whole: ProgramLog, *, cell: int, value: float) -> int:
    changes = whole.recording.changes
    return 1 + int(changes.step[(changes.cell == cell) & (changes.after <= value)][0])


def _first_other_policy(whole: ProgramLog) -> int:
    def best(table: np.ndarray[tuple[int]]) -> list[list[bool]]:
        rows = table.reshape(-1, 4)
        equal: list[list[bool]] = (rows == rows.max(axis=1, keepdims=True)).tolist()
        return equal

    recording = whole.recording
    return next(
        step
        for step in range(1, recording.count)
        if best(recording.table_at(step)) != best(recording.table_at(step - 1))
    )


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
