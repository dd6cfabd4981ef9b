"""The moments when a frame may be sent."""

from __future__ import annotations

from math import inf

import pytest

from rl_tui.screen.terminal.link import ANSWER_LINE, Link


class Clock:
    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def link(clock: Clock) -> Link:
    return Link(clock)


def carry(link: Link, clock: Clock, size: int, seconds: float) -> None:
    column = link.send(size, 80)
    assert column is not None
    clock.now += seconds
    assert link.answer(column, ANSWER_LINE)


def test_a_frame_waits_until_the_one_before_has_arrived(link: Link, clock: Clock) -> None:
    assert link.wait == 0.0
    column = link.send(2_000, 80)
    clock.now += 0.3
    assert link.wait > 0.0
    assert not link.is_idle
    assert column is not None
    assert link.answer(column, ANSWER_LINE)
    assert link.wait == 0.0
    assert link.is_idle


def test_only_the_answer_to_the_newest_frame_frees_the_link(link: Link, clock: Clock) -> None:
    first = link.send(2_000, 80)
    clock.now += 10.0
    second = link.send(2_000, 80)
    assert first is not None
    assert second is not None
    assert link.answer(first, ANSWER_LINE)
    assert link.wait > 0.0
    assert link.answer(second, ANSWER_LINE)
    assert link.wait == 0.0


def test_what_was_not_asked_is_no_answer(link: Link) -> None:
    column = link.send(2_000, 80)
    assert column is not None
    assert not link.answer(column, 0), "shift+F3 is a cursor position in the first line"
    assert not link.answer(column + 1, ANSWER_LINE)
    assert link.wait > 0.0
    assert link.answer(column, ANSWER_LINE)
    assert not link.answer(column, ANSWER_LINE)


@pytest.mark.parametrize("width", [1, 2, 60, 200])
def test_the_columns_lie_in_the_terminal(link: Link, width: int) -> None:
    for _ in range(130):
        column = link.send(10, width)
        assert column is not None
        assert 0 <= column < width
        assert link.answer(column, ANSWER_LINE) or width == 1


def test_a_late_answer_is_waited_for_longer_after_more_bytes(link: Link, clock: Clock) -> None:
    link.send(15_000, 80)
    clock.now += 2.0
    assert link.wait > 0.0, "15 kB take two seconds on a slow link"
    clock.now += 2.9
    assert link.wait == 0.0
    link.send(100, 80)
    assert link.wait > 3.0, "it may be that the 15 kB are still on their way"


def test_no_terminal_is_waited_for_for_ever(link: Link, clock: Clock) -> None:
    carry(link, clock, 2_000, 0.1)
    link.send(1_000_000, 80)
    assert link.wait == pytest.approx(5.0)
    clock.now += 5.0
    assert link.wait == 0.0


def test_after_a_key_it_is_not_waited_for_so_long(link: Link, clock: Clock) -> None:
    link.send(20_000, 80)
    clock.now += 1.0
    assert link.wait > 0.0
    link.hurry()
    assert link.wait == 0.0
    link.send(2_000, 80)
    assert link.wait > 1.0, "the hurry was for one frame"


def test_a_terminal_that_never_answers_gets_frame_after_frame(link: Link, clock: Clock) -> None:
    for _ in range(4):
        assert not link.is_silent
        link.send(1_000, 80)
        clock.now += link.wait
    assert link.is_silent
    asked = 0
    for _ in range(50):
        assert link.wait == 0.0
        assert link.is_idle
        asked += link.send(1_000, 80) is not None
        clock.now += 0.1
    assert 4 <= asked <= 6, "once a second it is asked again"


def test_a_terminal_that_answers_after_all_is_waited_for_from_then_on(link: Link, clock: Clock) -> None:
    columns = []
    for _ in range(4):
        columns.append(link.send(1_000, 80))
        clock.now += link.wait
    assert link.is_silent
    assert columns[-1] is not None
    assert link.answer(columns[-1], ANSWER_LINE)
    assert not link.is_silent
    link.send(1_000, 80)
    assert link.wait > 0.0


def test_a_terminal_that_has_answered_is_never_taken_for_silent(link: Link, clock: Clock) -> None:
    carry(link, clock, 1_000, 0.1)
    for _ in range(20):
        link.send(1_000, 80)
        clock.now += link.wait
        assert not link.is_silent
    assert link.wait == 0.0


def test_frames_are_no_longer_than_a_slow_link_carries_in_a_fifth_of_a_second(
    link: Link, clock: Clock
) -> None:
    assert link.room == inf
    carry(link, clock, 60, 0.05)
    for _ in range(20):
        carry(link, clock, 3_000, 0.05 + 0.3)
    assert link.room == pytest.approx(2_000, rel=0.1)
    for _ in range(20):
        carry(link, clock, 3_000, 0.05 + 3.0)
    assert link.room == 1_000
    for _ in range(40):
        carry(link, clock, 3_000, 0.05)
    assert link.room > 100_000, "the link is quick again"


def test_a_long_way_is_not_a_slow_link(link: Link, clock: Clock) -> None:
    carry(link, clock, 60, 0.4)
    for size in (500, 3_000, 20_000):
        carry(link, clock, size, 0.4)
    assert link.room == inf


def test_after_a_restart_nothing_is_under_way(link: Link) -> None:
    column = link.send(1_000, 80)
    link.restart()
    assert link.wait == 0.0
    assert column is not None
    assert not link.answer(column, ANSWER_LINE)
