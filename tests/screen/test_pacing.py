from __future__ import annotations

import asyncio

import pytest

from rl_tui.screen.board.frames import Pacer
from rl_tui.screen.playground.actions.run import faster, slower


class Clock:
    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        return self.now


def test_frames_are_an_interval_apart() -> None:
    clock = Clock()
    pacer = Pacer(10.0, clock=clock)
    assert pacer.pause == 0.0
    pacer.begin()
    clock.now = 0.03
    pacer.end()
    assert pacer.pause == pytest.approx(0.07)
    clock.now = 0.2
    assert pacer.pause == 0.0


def test_slow_frames_stretch_the_interval() -> None:
    clock = Clock()
    pacer = Pacer(10.0, clock=clock)
    for _ in range(20):
        pacer.begin()
        clock.now += 0.4
        pacer.end()
        clock.now += pacer.pause
    pacer.begin()
    clock.now += 0.4
    pacer.end()
    assert pacer.pause == pytest.approx(0.4, abs=0.01)


async def test_who_is_in_a_hurry_does_not_wait() -> None:
    pacer = Pacer(0.001, clock=Clock())
    pacer.begin()
    pacer.end()
    waiting = asyncio.create_task(pacer.wait())
    pacer.hurry()
    await waiting
    pacer.begin()
    await pacer.wait()
    pacer.begin()
    assert pacer.pause == pytest.approx(1000.0)


def test_speeds_climb_from_one_to_as_fast_as_it_goes() -> None:
    climbed: list[float | None] = [1.0]
    while climbed[-1] is not None:
        climbed.append(faster(climbed[-1]))
    assert climbed == [1, 3, 10, 30, 100, 300, 1000, 3000, 10_000, 30_000, 100_000, None]
    assert faster(None) is None


def test_speeds_go_down_to_one() -> None:
    assert slower(None) == 100_000
    assert slower(10.0) == 3.0
    assert slower(1.0) == 1.0
    assert slower(7.0) == 3.0
