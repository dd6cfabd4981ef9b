"""Whether training waits for machine code, goes on interpreted meanwhile, or never needs any."""

from __future__ import annotations

import math
import os
import time
from typing import Final

from rl_tui.agents.compiling.background import BACKGROUND
from rl_tui.agents.compiling.cache_folder import was_compiled
from rl_tui.agents.kernels.machine_code import Loop
from rl_tui.agents.learner import Learner

# Seconds of interpreted training. To import numba and read machine code from the cache takes half a second,
# to compile it some eight: a worker that is ended before has done nothing
FIRST_LOOK: Final = 0.1
WORTH_READING: Final = 0.5
WORTH_COMPILING: Final = 5.0
# What trains many runs by one call takes two more, and saves most of what Python does between runs
WORTH_BATCHING: Final = 60.0
SURE_ENOUGH: Final = 1.0
"""So long it has to go on before a compiler is asked for: the first episodes may be by far the longest."""
_SMALLEST_CHUNK: Final = 64
_SHORT_WAIT: Final = 0.005
_COMPILED_CHUNK: Final = 2_000_000


def cores() -> int:
    """Return how many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class Patience:
    """Looks, as training goes on, how long the rest will take, and gets machine code where that pays."""

    def __init__(self) -> None:
        self._loop: Loop | None = None
        self._start = self._stretch = self._last = 0.0
        self._done = 0
        self._chunk = _SMALLEST_CHUNK
        self._is_read, self._is_asked_for = False, False

    def chunk(self, learner: Learner) -> int:
        """Return how many steps to take before the next look."""
        return _COMPILED_CHUNK if learner.is_compiled else self._chunk

    def look(self, learner: Learner, done: int, wanted: int) -> float:
        """Look, with ``done`` of ``wanted`` steps or episodes; return for how many seconds training waited.

        The first look only notes where it began.
        """
        now = time.perf_counter()
        if learner.is_compiled:
            return 0.0
        if learner.loop != self._loop:  # each has machine code of its own
            self._loop, self._start, self._stretch, self._done = learner.loop, now, now, done
            self._is_read, self._is_asked_for = False, False
            self._chunk = _SMALLEST_CHUNK
        elif now - self._last < FIRST_LOOK / 4:
            self._chunk *= 2
        while BACKGROUND.is_loading:
            time.sleep(_SHORT_WAIT)
        if now - self._stretch >= FIRST_LOOK:
            rate = (done - self._done) / (now - self._stretch)
            self._stretch, self._done = now, done
            if rate > 0.0 or now - self._start >= WORTH_READING:
                self._get_what_pays(learner.loop, (wanted - done) / rate if rate else math.inf)
        self._last = time.perf_counter()
        return self._last - now

    def _get_what_pays(self, loop: Loop, seconds: float) -> None:
        """Get machine code if the rest takes so many ``seconds`` interpreted."""
        if not self._is_read and seconds > WORTH_READING and was_compiled(loop):
            self._is_read = True
            if BACKGROUND.read(loop):
                return
        is_sure = time.perf_counter() - self._start >= SURE_ENOUGH
        if self._is_asked_for or seconds <= WORTH_COMPILING or not is_sure:
            return
        self._is_asked_for = True
        if cores() == 1:  # a compiler beside it would take its time away
            BACKGROUND.get(loop)
        else:
            BACKGROUND.want([loop])


def pays(loop: Loop, seconds: float) -> bool:
    """Return whether machine code is worth the wait where all there is to do takes so long interpreted."""
    return seconds > WORTH_COMPILING or (seconds > WORTH_READING and was_compiled(loop))


def batching_pays(batched: Loop, seconds: float) -> bool:
    """Return whether machine code to train many runs at once is worth the wait, as :func:`pays` does."""
    return seconds > WORTH_BATCHING or (seconds > WORTH_READING and was_compiled(batched))


def seconds_interpreted(learner: Learner, wanted: int, *, episodes: bool) -> float:
    """Return how long ``wanted`` steps or episodes of a fresh ``learner`` will take interpreted, roughly.

    It takes some steps of it to see, in at most about ``FIRST_LOOK`` seconds, or ``WORTH_READING`` where no
    episode ends before.
    """
    start = time.perf_counter()
    chunk, done = _SMALLEST_CHUNK, 0
    while (spent := time.perf_counter() - start) < (FIRST_LOOK if done else WORTH_READING):
        done = learner.episodes if episodes else learner.step
        if done >= wanted or learner.stop_reason:
            return spent
        learner.advance(chunk)
        learner.drain_episodes()
        chunk *= 2
    return wanted * spent / done if done else math.inf
