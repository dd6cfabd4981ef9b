"""A program is diagnosed while it runs."""

from __future__ import annotations

import threading

import numpy as np
import pytest
from watched_scripts import wait_until

from rl_tui.programs.diagnosis import verdicts
from rl_tui.programs.diagnosis.verdicts import Verdicts
from rl_tui.programs.evidence.verdict import ProgramVerdict
from rl_tui.programs.watched.messages import CHANGE_WIDTH, STEP_WIDTH
from rl_tui.programs.watched.program_log import ProgramLog
from rl_tui.programs.watched.recording import Recording

MOST = 100


def grown(recording: Recording, steps: int, value: float) -> None:
    changes = np.zeros((steps, CHANGE_WIDTH))
    changes[:, 0] = recording.count + np.arange(steps)
    changes[:, 3] = value
    recording.add(np.zeros((steps, STEP_WIDTH)), changes)


@pytest.fixture
def log() -> ProgramLog:
    log = ProgramLog(recording=Recording(MOST))
    log.recording.find_table(0, 1, np.zeros(1))
    grown(log.recording, 50, 1.0)
    return log


def test_what_is_frozen_stays_as_it_was(log: ProgramLog) -> None:
    frozen = log.frozen().recording
    grown(log.recording, 40, 2.0)
    grown(log.recording, 40, 3.0)  # the older half is forgotten
    assert log.recording.first > 0
    assert (frozen.first, frozen.count) == (0, 50)
    assert {len(column) for column in (*frozen.steps, *frozen.changes)} == {50}
    assert frozen.table_at(50).tolist() == [1.0]
    assert log.recording.table_at(130).tolist() == [3.0]


def test_what_comes_with_no_further_step_is_judged_too(
    log: ProgramLog, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen: list[int] = []

    def judged(log: ProgramLog) -> ProgramVerdict:
        seen.append(len(log.recording.changes.step))
        return ProgramVerdict()

    monkeypatch.setattr(verdicts, "verdict_of", judged)
    newest = Verdicts(lambda: None, automatic=False)
    for _ in range(2):
        newest.look(log, is_still=True)
    log.recording.add(np.empty((0, STEP_WIDTH)), np.array([[49.0, 0.0, 1.0, 2.0]]))
    newest.look(log, is_still=True)
    assert seen == [50, 51]


def test_where_there_is_no_thread_to_be_had_it_tries_again(
    log: ProgramLog, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(_: threading.Thread) -> None:
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr(verdicts, "EVERY", 0.0)
    newest = Verdicts(lambda: None, automatic=True)
    with monkeypatch.context() as scarce:
        scarce.setattr(threading.Thread, "start", fails)
        newest.look(log, is_still=True)
    monkeypatch.setattr(verdicts, "verdict_of", lambda _: ProgramVerdict(notes=("there",)))
    newest.look(log, is_still=True)
    wait_until(lambda: bool(newest.newest.notes))
