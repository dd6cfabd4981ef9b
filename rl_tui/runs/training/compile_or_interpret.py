"""Decides whether training waits for machine code, continues interpreted, or needs none."""

from __future__ import annotations

import math
import os
import time
from typing import Final

from rl_tui.agents.compiling.background import BACKGROUND
from rl_tui.agents.compiling.cache_folder import was_compiled
from rl_tui.agents.kernels.machine_code import Loop
from rl_tui.agents.learner import Learner

# Seconds of interpreted training. Importing numba and reading cached machine code takes half a second;
# compiling takes about eight, and is lost if the worker ends before.
FIRST_LOOK: Final = 0.1
WORTH_READING: Final = 0.5
WORTH_COMPILING: Final = 5.0
# Compiling the loop for batches takes two more seconds, and saves most of the Python overhead between runs
WORTH_BATCHING: Final = 60.0
SURE_ENOUGH: Final = 1.0
"""Seconds of training before compilation is requested, since the first episodes may be the longest."""
_SMALLEST_CHUNK: Final = 64
_SHORT_WAIT: Final = 0.005
_COMPILED_CHUNK: Final = 2_000_000


def cores() -> int:
    """Return the number of cores available to this process."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class Patience:
    """Requests machine code during training if that pays."""

    def __init__(self) -> None:
        self._loop: Loop | None = None
        self._start = self._stretch = self._last = 0.0
        self._done = 0
        self._chunk = _SMALLEST_CHUNK
        self._is_read, self._is_asked_for = False, False

    def chunk(self, learner: Learner) -> int:
        """Return the number of steps before the next look."""
        return _COMPILED_CHUNK if learner.is_compiled else self._chunk

    def look(self, learner: Learner, done: int, wanted: int) -> float:
        """Update the estimate and return the seconds spent waiting; `done` and `wanted` in one unit."""
        now = time.perf_counter()
        if learner.is_compiled:
            return 0.0
        if learner.loop != self._loop:  # each loop has its own machine code
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
        if not self._is_read and seconds > WORTH_READING and was_compiled(loop):
            self._is_read = True
            if BACKGROUND.read(loop):
                return
        is_sure = time.perf_counter() - self._start >= SURE_ENOUGH
        if self._is_asked_for or seconds <= WORTH_COMPILING or not is_sure:
            return
        self._is_asked_for = True
        if cores() == 1:  # a compiler in parallel would take its time
            BACKGROUND.get(loop)
        else:
            BACKGROUND.want([loop])


def pays(loop: Loop, seconds: float) -> bool:
    """Return True if machine code pays for `seconds` of interpreted work."""
    return seconds > WORTH_COMPILING or (seconds > WORTH_READING and was_compiled(loop))


def batching_pays(batched: Loop, seconds: float) -> bool:
    """Return True if machine code for batches pays for `seconds` of work."""
    return seconds > WORTH_BATCHING or (seconds > WORTH_READING and was_compiled(batched))


def seconds_interpreted(learner: Learner, wanted: int, *, episodes: bool) -> float:
    """Estimate the duration of interpreted training by some steps, for `FIRST_LOOK` seconds or more."""
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
