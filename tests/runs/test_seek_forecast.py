"""The forecast of a seek's duration."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from rl_tui.live.pace.transport import Transport

STEPS = 2_000_000
FIRST_CALL = 0.3  # seconds


class SlowStart:
    def __init__(self, rate: float) -> None:
        self.now, self.done, self._rate, self._wait = 0.0, 0, rate, FIRST_CALL
        self.program = None
        self.current = self.built_in = SimpleNamespace(
            run=SimpleNamespace(learner=SimpleNamespace(rewindable=True))
        )

    @property
    def progress(self) -> tuple[int, int]:
        return self.done, STEPS

    @property
    def seeking(self) -> bool:
        return self.done < STEPS

    def continue_seek(self, steps: int) -> int:
        taken = min(steps, STEPS - self.done)
        self.now, self.done, self._wait = self.now + self._wait + taken / self._rate, self.done + taken, 0.0
        return taken


@pytest.mark.parametrize("rate", [100.0, 50_000.0, 1_000_000.0, 10_000_000.0])
def test_a_forecast_is_right_or_there_is_none(rate: float) -> None:
    group: Any = SlowStart(rate)
    transport = Transport(group, speed=None, automatic=True, clock=lambda: group.now)
    transport.measure_anew()
    said = set[bool]()
    while not transport.continue_seek(0.015) and group.now < 30.0:
        message = transport.seek_message(waits=False)
        said.add("left" in message)
        if "left" in message and rate == 50_000.0:
            left = (STEPS - group.done) / rate
            told = float(message.split("about ")[1].split()[0])
            assert abs(told - left) <= 0.1 * left + 1.0
    assert said == ({False} if rate > 5e6 else {False, True})
