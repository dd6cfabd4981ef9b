"""A program waits in step and reset."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from held_programs import held
from watched_scripts import LOOP, script_in, watched

from rl_tui.programs.watched.program_log import ProgramLog

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
