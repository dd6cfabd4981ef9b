"""Training without a screen."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from rl_tui.lab.run import Run
from rl_tui.worlds.errors import UserError

CHUNK: Final = 2_000_000
# An environment that is stepped for real takes some 50 µs a step
STEPPED_CHUNK: Final = 2_000

OnProgress = Callable[[int, int], None]


def no_progress(done: int, wanted: int) -> None:
    """Ignore how far training has come."""


@dataclass(frozen=True, slots=True)
class Goal:
    """When training ends: after so many episodes or so many steps in all."""

    steps: int | None = None
    episodes: int | None = None

    def reached_by(self, run: Run) -> tuple[int, int]:
        """Return how much of it ``run`` has done, and the whole."""
        if self.steps is not None:
            return run.step, self.steps
        return run.learner.episodes, self.episodes or 0


def train(run: Run, goal: Goal, on_progress: OnProgress = no_progress) -> float:
    """Advance ``run`` to ``goal`` and return the seconds it took, compiling left out.

    Raises UserError where the run broke down.
    """
    run.warm_up()
    start = time.perf_counter()
    chunk = CHUNK if run.world.new_environment is None else STEPPED_CHUNK
    while True:
        done, wanted = goal.reached_by(run)
        on_progress(done, wanted)
        if done >= wanted or run.converged:
            return time.perf_counter() - start
        left = wanted - done
        if goal.steps is not None:
            run.advance(min(chunk, left))
        else:
            run.advance(chunk, left)
        if run.stop_reason:
            raise UserError(run.stop_reason)
