"""The due steps, and the measured speed. Times are in seconds."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import Final

START_SPEED: Final = 10.0
"""Initial speed of a playground in steps per second."""
TICK: Final = 1 / 60
MOST_DEBT: Final = 0.25
CHUNK: Final = 0.015
AT_ONCE: Final = 0.015
# a step of Dyna-Q may take as long as 30,000 of Q-learning, and a step of an environment any time
FIRST_CHUNK: Final = 1
LARGEST_CHUNK: Final = 4_000_000
WINDOW: Final = 1.0
SHORTEST_MEASURE: Final = 0.2


class Pace:
    """Timing of steps at a constant speed."""

    def __init__(self) -> None:
        self._speed = 1.0
        self._origin = 0.0
        self._taken = 0

    def start(self, speed: float, now: float, at_once: bool) -> None:
        """Aim at `speed` steps per second from `now` on, the first step `at_once` or not."""
        self._speed = speed
        self._origin = now - 1 / speed if at_once else now
        self._taken = 0

    def due(self, now: float) -> int:
        """Return the number of steps due. Delays above a quarter of a second are forgotten."""
        # a clock read slightly early must not delay a step by a whole wait
        due = int((now - self._origin) * self._speed + 1e-6) - self._taken
        if due > 1 and due / self._speed > MOST_DEBT:
            due = max(1, int(MOST_DEBT * self._speed))
            self._origin, self._taken = now - due / self._speed, 0
        return due

    def took(self, steps: int) -> None:
        """Record that `steps` were taken."""
        self._taken += steps

    def wait(self, now: float) -> float:
        """Return the time until the next step, at high speeds until the next sixtieth."""
        ahead = self._origin + (self._taken + 1) / self._speed - now
        if self._speed <= 1 / TICK:
            return max(ahead, 0.0)
        # Steps that became due during the last ones do not count yet: without a pause the player's thread
        # would never release its lock
        return 0.0 if ahead < -TICK else max(ahead, TICK)


@dataclass(slots=True)
class ChunkSize:
    """The steps in one chunk, so that commands never wait long."""

    steps: int = FIRST_CHUNK

    def measured(self, steps: int, seconds: float) -> None:
        """Adapt to a full chunk of `steps`."""
        fitting = steps * CHUNK / seconds if seconds > 0.0 else float(LARGEST_CHUNK)
        self.steps = int(min(max(fitting, 1.0), 4.0 * self.steps, LARGEST_CHUNK))


class SpeedMeter:
    """Steps per second over about a second, or three steps."""

    def __init__(self) -> None:
        self._readings: deque[tuple[float, int]] = deque()

    def clear(self) -> None:
        """Forget all readings."""
        self._readings.clear()

    def note(self, now: float, step: int, speed: float | None) -> None:
        """Record the run's step and its chosen speed."""
        readings = self._readings
        if len(readings) > 1 and now - readings[-2][0] < WINDOW / 20:
            readings.pop()
        readings.append((now, step))
        window = WINDOW if speed is None else max(WINDOW, 3 / speed)
        while len(readings) > 2 and now - readings[1][0] >= window:
            readings.popleft()

    @property
    def steps_per_second(self) -> float | None:
        """Measured speed, if known yet."""
        if len(self._readings) < 2:
            return None
        (first, first_step), (last, last_step) = self._readings[0], self._readings[-1]
        return (last_step - first_step) / (last - first) if last - first >= SHORTEST_MEASURE else None
