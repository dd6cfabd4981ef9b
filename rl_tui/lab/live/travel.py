"""Bringing lanes to another moment, a short piece at a time, and telling how long it takes."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Final

from rl_tui.common.words import lasting
from rl_tui.lab.live.pacing import ChunkSize

if TYPE_CHECKING:
    from rl_tui.lab.timeline.run_group import RunGroup

AT_ONCE: Final = 0.015
NEWS_EVERY: Final = 0.25
_WORTH_A_FORECAST: Final = 0.5


class Travel:
    """One journey of ``lanes``; ``clock`` gives seconds."""

    def __init__(self, lanes: RunGroup, clock: Callable[[], float]) -> None:
        self._lanes = lanes
        self._clock = clock
        self._chunk = ChunkSize()
        self._start = self._last_news = clock()
        self._taken = 0

    @property
    def done(self) -> bool:
        """Whether all are where they have to be."""
        return not self._lanes.travel

    def go_on(self, seconds: float) -> None:
        """Travel for about so many seconds, or until it is done."""
        until = self._clock() + seconds
        while not self.done:
            before, wanted = self._clock(), self._chunk.steps
            taken = self._lanes.work_off(wanted)
            self._taken += taken
            now = self._clock()
            if taken == wanted:
                self._chunk.measured(taken, now - before)
            if now >= until:
                return

    def has_news(self) -> bool:
        """Tell whether it is time to show how far it has come."""
        now = self._clock()
        if now - self._last_news < NEWS_EVERY:
            return False
        self._last_news = now
        return True

    @property
    def message(self) -> str:
        """How far it has come and how long it will take, as far as that is known."""
        done, steps = self._lanes.progress
        begins = "" if self._lanes.current.run.learner.rewindable else " from the seed"
        words = f"replaying{begins}: {done:,} of {steps:,} steps"
        spent = self._clock() - self._start
        if spent < _WORTH_A_FORECAST or not self._taken:
            return words
        left = (steps - done) * spent / self._taken
        return f"{words}, about {lasting(left)} left"
