"""The duration of a background question."""

from __future__ import annotations

import pytest

from rl_tui.runs.background.pace import MACHINE_IS_BUSY, PATIENCE, Pace, how_long


class Clock:
    now = 100.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock() -> Clock:
    return Clock()


def test_nothing_is_known_before_the_first_result(clock: Clock) -> None:
    pace = Pace(clock, is_busy=lambda: False)
    clock.now += 60.0
    pace.note()  # messages without a fraction, such as a stage, are not results
    assert pace.seconds_left is None
    assert how_long(pace.seconds_left, is_held_up=False) == ""


def test_the_rest_takes_as_long_as_what_is_done_has_taken(clock: Clock) -> None:
    pace = Pace(clock, is_busy=lambda: False)
    clock.now += 10.0
    pace.note(0.25)
    assert pace.seconds_left == pytest.approx(30.0)
    clock.now += 5.0
    pace.note(0.5)  # 5 s per quarter: the time before the first result may include compiling
    assert pace.seconds_left == pytest.approx(10.0)
    assert how_long(pace.seconds_left, is_held_up=False) == "about 10 s left"
    pace.note(1.0)
    assert pace.seconds_left == 0.0


@pytest.mark.parametrize(
    ("is_busy", "waits", "is_held_up"),
    [(True, PATIENCE, True), (True, PATIENCE - 0.1, False), (False, 10 * PATIENCE, False)],
)
def test_it_is_held_up_where_it_does_not_get_on_while_others_keep_the_machine_busy(
    clock: Clock, is_busy: bool, waits: float, is_held_up: bool
) -> None:
    pace = Pace(clock, is_busy=lambda: is_busy)
    clock.now += waits
    assert pace.is_held_up is is_held_up
    pace.note(0.1)
    assert not pace.is_held_up


def test_a_busy_machine_is_named_in_place_of_a_time() -> None:
    assert how_long(40.0, is_held_up=True) == MACHINE_IS_BUSY
