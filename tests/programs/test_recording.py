"""The recording of a program, and its diagnosis while the program runs."""

from __future__ import annotations

import threading

import numpy as np
import pytest
from watched_scripts import wait_until

from rl_tui.programs.diagnosis import verdicts
from rl_tui.programs.diagnosis.verdicts import Verdicts
from rl_tui.programs.evidence.verdict import ProgramVerdict
from rl_tui.programs.grading.agent_training import EpisodeRecording
from rl_tui.programs.watched import recording as of_recording
from rl_tui.programs.watched.messages import CHANGE_WIDTH, STEP_WIDTH
from rl_tui.programs.watched.program_log import ProgramLog
from rl_tui.programs.watched.recording import Recording

CELLS = 6


def _batches(
    steps: int, seed: int, changes_of_a_step: int = 2
) -> list[tuple[np.ndarray[tuple[int, int]], np.ndarray[tuple[int, int]]]]:
    random, table, batches, at = np.random.default_rng(seed), np.zeros(CELLS), [], 0
    while at < steps:
        size = int(random.integers(1, 40))
        rows = [[0, at + i, 1, 0.5, at + i + 1, i % 4, at // 10, i] for i in range(size)]
        changes = []
        for step in range(at, at + size):
            for _ in range(int(random.integers(0, changes_of_a_step + 1))):
                cell, after = int(random.integers(CELLS)), float(random.normal())
                changes.append([step, cell, table[cell], after])
                table[cell] = after
        batches.append((np.array(rows, float), np.array(changes, float).reshape(-1, 4)))
        at += size
    return batches


@pytest.mark.parametrize(("most", "each"), [(10_000, 2), (100, 2), (100, 30)])
def test_the_table_of_any_moment_is_that_of_a_plain_replay(
    monkeypatch: pytest.MonkeyPatch, most: int, each: int
) -> None:
    monkeypatch.setattr(of_recording, "BETWEEN_KEYFRAMES", 20)
    recording = Recording(most)
    recording.find_table(0, 2, np.zeros(CELLS))
    came: list[list[float]] = []

    for steps, changes in _batches(1000, most + each, each):
        recording.add(steps, changes)
        came += changes.tolist()

        assert len(recording.steps.state) <= most + 40
        assert len(recording.changes.cell) <= 4 * most + 40 * each
        for moment in {recording.first, (recording.first + recording.count) // 2, recording.count}:
            table = np.zeros(CELLS)
            for step, cell, _, after in came:
                if step < moment:
                    table[int(cell)] = after
            np.testing.assert_array_equal(recording.table_at(moment), table)
    assert (recording.first > 0) == (most == 100)
    assert recording.steps.state.tolist() == list(range(recording.first, recording.count))
    assert recording.changes.step[0] >= recording.first


def test_what_was_given_out_does_not_change_when_more_comes() -> None:
    recording = Recording()
    recording.find_table(0, 2, np.zeros(CELLS))
    (steps, changes), *later = _batches(5000, 1)
    recording.add(steps, changes)
    given, then = recording.steps.state, recording.steps.state.copy()
    for batch in later:
        recording.add(*batch)

    np.testing.assert_array_equal(given, then)


def test_a_moment_that_is_forgotten_is_refused() -> None:
    recording = Recording(50)
    with pytest.raises(ValueError, match="no table"):
        recording.table_at(0)
    recording.find_table(0, 2, np.zeros(CELLS))
    for batch in _batches(200, 2):
        recording.add(*batch)

    with pytest.raises(ValueError, match="no longer kept"):
        recording.table_at(0)


def test_the_older_half_of_two_tables_is_dropped() -> None:
    recording, tables = Recording(50), np.zeros((2, CELLS))
    recording.find_table(0, 2, np.zeros(CELLS))
    recording.find_pair(0, np.zeros(2 * CELLS))
    for steps, changes in _batches(200, 3):
        rows = []
        for number, cell, _, after in changes:
            table, place, before = int(number) % 2, int(cell), tables.mean(0)
            rows.append([number, CELLS * (1 + table) + place, tables[table, place], after])
            tables[table, place] = after
            rows.append([number, place, before[place], tables.mean(0)[place]])
        recording.add(steps, np.array(rows).reshape(-1, 4))

    assert recording.paired_at == recording.first > 0
    assert recording.table_at(recording.count).tolist() == tables.mean(0).tolist()
    changes = recording.changes_of_pair
    assert len(changes.step) == len(recording.changes.step)
    both = recording.initial_pair.copy()
    for cell, before, after in zip(changes.cell, changes.before, changes.after, strict=True):
        assert both[cell] == before
        both[cell] = after
    assert both.tolist() == tables.ravel().tolist()


@pytest.mark.parametrize("size", [1, 7, 64])
def test_returns_do_not_depend_on_how_many_steps_come_at_once(size: int) -> None:
    returns: list[float] = []
    recording = EpisodeRecording(1, 1, lambda found, lengths: returns.extend(found))
    rewards = np.arange(64.0)
    steps = np.array([[i, 0, 0, reward, 0, i % 5 == 4, i // 5, i] for i, reward in enumerate(rewards)])
    for first in range(0, len(steps), size):
        recording.add(steps[first : first + size], np.empty((0, 4)))
    assert returns == [rewards[first : first + 5].sum() for first in range(0, 60, 5)]


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
