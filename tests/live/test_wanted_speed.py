from __future__ import annotations

import pytest

from rl_tui.live.pace.pacing import CHUNK, LARGEST_CHUNK, TICK, ChunkSize, Pace, SpeedMeter


def test_the_first_step_is_due_at_once_and_the_others_at_their_times() -> None:
    pace = Pace()
    pace.start(10.0, now=5.0, at_once=True)
    assert pace.due(5.0) == 1
    pace.took(1)
    assert pace.due(5.05) == 0
    assert pace.wait(5.05) == pytest.approx(0.05)
    assert pace.due(5.1) == 1
    pace.took(1)
    assert pace.wait(5.1) == pytest.approx(0.1)


def test_a_new_speed_waits_for_its_own_first_step() -> None:
    pace = Pace()
    pace.start(1.0, now=0.0, at_once=False)
    assert pace.due(0.9) == 0
    assert pace.due(1.0) == 1


def test_fast_steps_come_in_ticks() -> None:
    pace = Pace()
    pace.start(3000.0, now=0.0, at_once=False)
    assert pace.wait(0.0) == pytest.approx(1 / 60)
    assert pace.due(1 / 60) == 50


def test_what_was_missed_for_long_is_let_go() -> None:
    pace = Pace()
    pace.start(100.0, now=0.0, at_once=False)
    assert pace.due(60.0) == 25
    pace.took(25)
    assert pace.due(60.0) == 0
    assert pace.due(60.01) == 1
    pace.start(1.0, now=0.0, at_once=False)
    assert pace.due(60.0) == 1


def test_a_learner_that_lags_behind_does_not_wait() -> None:
    pace = Pace()
    pace.start(1000.0, now=0.0, at_once=False)
    pace.took(pace.due(0.1) - 50)
    assert pace.wait(0.1) == 0.0


def test_chunks_grow_and_shrink_to_their_time() -> None:
    chunk = ChunkSize()
    for _ in range(20):
        chunk.measured(chunk.steps, chunk.steps / 30e6)
    assert chunk.steps == pytest.approx(30e6 * CHUNK, rel=0.01)
    chunk.measured(chunk.steps, chunk.steps / 1e3)
    assert chunk.steps == pytest.approx(1e3 * CHUNK, rel=0.1)
    chunk.measured(chunk.steps, 100.0)
    assert chunk.steps == 1
    for _ in range(40):
        chunk.measured(chunk.steps, 0.0)
    assert chunk.steps == LARGEST_CHUNK


def test_the_meter_measures_the_last_second() -> None:
    meter = SpeedMeter()
    assert meter.steps_per_second is None
    for tick in range(100):  # half a second at 1,000 steps a second, then half at 3,000, then on
        now = tick / 50
        meter.note(now, round(1000 * now if now < 0.5 else 500 + 3000 * (now - 0.5)), None)
    assert meter.steps_per_second == pytest.approx(3000, rel=0.01)
    meter.clear()
    assert meter.steps_per_second is None


def test_the_meter_sees_three_steps_of_a_slow_run() -> None:
    meter = SpeedMeter()
    for step in range(10):
        meter.note(float(step), step, 1.0)
    assert meter.steps_per_second == pytest.approx(1.0)


def test_steps_that_fall_due_while_others_are_taken_wait_for_the_next_tick() -> None:
    pace = Pace()
    pace.start(100_000.0, now=0.0, at_once=False)
    pace.took(pace.due(TICK))
    assert pace.wait(TICK + 0.001) == TICK
    assert pace.due(2 * TICK) == pytest.approx(100_000 * TICK, abs=1)
